#include "armcmc/drift_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "fixed_size.hpp"

namespace armcmc {

// Of Eigen's templates for a size that is not known, clang sees the branch for large ones, which goes to the heap and
// is not taken (linear_algebra.hpp).
ARMCMC_TRUST_NONBLOCKING_BEGIN

namespace {

constexpr double kLeastDeterminant = 1e-300;

/// (M + M') / 2 of what is symmetric but for rounding.
template <class Matrix>
void MakeSymmetricOf(Matrix* m) noexcept {
  *m = (0.5 * (*m + m->transpose())).eval();
}

/// A^-1 B, column by column: Eigen unrolls the solution for a vector of known size, and not that for a matrix.
template <class Matrix>
Matrix Solved(const Eigen::PartialPivLU<Matrix>& factor, const Matrix& b) noexcept {
  Matrix x(b.rows(), b.cols());
  for (Eigen::Index j = 0; j < b.cols(); ++j) x.col(j) = factor.solve(b.col(j));
  return x;
}

/// Half the log of the determinant, NaN where the matrix is not positive definite.
template <class Matrix>
double HalfLogDeterminant(const Eigen::LLT<Matrix>& factor) noexcept {
  if (factor.info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
  double product = 1.0;
  for (Eigen::Index i = 0; i < factor.rows(); ++i) product *= factor.matrixLLT()(i, i);
  return std::log(product);
}

/// The numbers of a filter, in the order in which it has them.
template <class F>
struct PartsOf {
  explicit PartsOf(DriftFilter* f) noexcept
      : u(F::Of(&f->u)), w(F::Of(&f->w)), uu(F::Of(&f->uu)), uw(F::Of(&f->uw)), ww(F::Of(&f->ww)) {}
  Eigen::Map<typename F::Vector> u, w;
  Eigen::Map<typename F::Matrix> uu, uw, ww;
};

template <class F>
double MultiplyByOf(const LocalLikelihood& local, const ParamVector& centre, DriftFilter* filter) noexcept {
  using Vector = typename F::Vector;
  using Matrix = typename F::Matrix;
  const auto h = F::Of(local.information);
  const auto a = F::Of(local.gradient);
  auto [u, w, uu, uw, ww] = PartsOf<F>(filter);
  // C <- (1 + C H)^-1 C, which needs no inverse of C, and w is updated through its covariance with u.
  Matrix spread = uu.lazyProduct(h);
  spread.diagonal().array() += 1.0;
  const Eigen::PartialPivLU<Matrix> factor(spread);
  const Vector apart = u - F::Of(centre);
  const Vector pulled = h.lazyProduct(apart);
  const Vector residual = a - pulled;
  const Matrix told = h.lazyProduct(uw);
  uu = Solved<Matrix>(factor, uu);
  uw = Solved<Matrix>(factor, uw);
  MakeSymmetricOf(&uu);
  const Vector move = uu.lazyProduct(residual);
  u += move;
  w += uw.transpose().lazyProduct(residual);
  ww -= uw.transpose().lazyProduct(told);
  MakeSymmetricOf(&ww);
  // What is not finite spreads to the sum.
  const double sum = w.sum() + uw.sum() + ww.sum() + uu.sum();
  return a.dot(apart) - 0.5 * apart.dot(pulled) + 0.5 * residual.dot(move) -
         0.5 * std::log(std::fmax(factor.determinant(), kLeastDeterminant)) + 0.0 * sum;
}

template <class F>
double ToEffectiveOf(const VelocityLikelihood& pack, DriftFilter* filter) noexcept {
  using Matrix = typename F::Matrix;
  using JointVector = typename F::JointVector;
  using JointMatrix = typename F::JointMatrix;
  const auto lead = F::Of(pack.lead);
  const auto mixed = F::Of(pack.mixed);
  auto [u, w, uu, uw, ww] = PartsOf<F>(filter);
  const Eigen::Index n = u.size();
  const auto size = Eigen::fix<F::kDim>(static_cast<int>(n));  // of blocks, known where that of the whole is
  u -= lead.lazyProduct(w);
  const Matrix moved = lead.lazyProduct(ww);
  const Matrix with_u = lead.lazyProduct(uw.transpose());
  uu += lead.lazyProduct(moved.transpose()) - with_u - with_u.transpose();
  uw -= moved;

  JointMatrix joint(2 * n, 2 * n);
  joint.topLeftCorner(size, size) = uu;
  joint.topRightCorner(size, size) = uw;
  joint.bottomLeftCorner(size, size) = uw.transpose();
  joint.bottomRightCorner(size, size) = ww;
  JointMatrix information(2 * n, 2 * n);
  information.topLeftCorner(size, size).setZero();
  information.topRightCorner(size, size) = mixed;
  information.bottomLeftCorner(size, size) = mixed.transpose();
  information.bottomRightCorner(size, size) = F::Of(pack.information);
  JointVector apart(2 * n);
  apart.head(size) = u - F::Of(pack.mode);
  apart.tail(size) = w;
  JointVector gradient(2 * n);
  gradient.head(size).setZero();
  gradient.tail(size) = F::Of(pack.gradient);

  // As above, of both together: a velocity may be known exactly.
  JointMatrix spread = joint.lazyProduct(information);
  spread.diagonal().array() += 1.0;
  const Eigen::PartialPivLU<JointMatrix> factor(spread);
  joint = Solved<JointMatrix>(factor, joint);
  MakeSymmetricOf(&joint);
  const JointVector pulled = information.lazyProduct(apart);
  const JointVector residual = gradient - pulled;
  const JointVector move = joint.lazyProduct(residual);
  u += move.head(size);
  w += move.tail(size);
  uu = joint.topLeftCorner(size, size);
  uw = joint.topRightCorner(size, size);
  ww = joint.bottomRightCorner(size, size);
  const Eigen::LLT<Matrix> root(uu);
  if (root.info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
  return apart.dot(gradient) - 0.5 * apart.dot(pulled) + 0.5 * residual.dot(move) -
         0.5 * std::log(factor.determinant()) + 0.0 * (joint.sum() + move.sum());
}

template <class F>
void FromEffectiveOf(const ParamMatrix& t, DriftFilter* filter) noexcept {
  using Matrix = typename F::Matrix;
  const auto lead = F::Of(t);
  auto uw = F::Of(&filter->uw);
  F::Of(&filter->u) += lead.lazyProduct(F::Of(&filter->w));
  const Matrix moved = lead.lazyProduct(F::Of(&filter->ww));
  const Matrix with_u = lead.lazyProduct(uw.transpose());
  F::Of(&filter->uu) += lead.lazyProduct(moved.transpose()) + with_u + with_u.transpose();
  uw += moved;
}

template <class F>
void TransformOf(const ParamMatrix& by, const ParamVector& from, const ParamVector& to, DriftFilter* filter) noexcept {
  using Matrix = typename F::Matrix;
  const auto map = F::Of(by);
  auto u = F::Of(&filter->u);
  auto uu = F::Of(&filter->uu);
  auto uw = F::Of(&filter->uw);
  const typename F::Vector apart = u - F::Of(from);
  u = F::Of(to) + map.lazyProduct(apart);
  const Matrix half = map.lazyProduct(uu);
  uu = half.lazyProduct(map.transpose());
  MakeSymmetricOf(&uu);
  const Matrix cross = map.lazyProduct(uw);
  uw = cross;
}

template <class F>
void PropagateOf(const DriftStep& step, const MovingParameters& moving, DriftFilter* filter) noexcept {
  auto [u, w, uu, uw, ww] = PartsOf<F>(filter);
  const typename F::Vector variance = uu.diagonal();
  u += step.b * w;
  uu += step.b * (uw + uw.transpose()) + step.b * step.b * ww;
  uw = step.phi * (uw + step.b * ww);
  w *= step.phi;
  ww *= step.phi * step.phi;
  for (Eigen::Index i = moving.first; i < moving.first + moving.count; ++i) {
    uu(i, i) += step.noise_uu;
    uw(i, i) += step.noise_uw;
    ww(i, i) += step.noise_ww;
  }
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const double kept = KeptShare(variance[i], uu(i, i));
    if (kept == 1.0) continue;
    const double shrink = std::sqrt(kept);
    u[i] *= kept;
    uu.row(i) *= shrink;
    uu.col(i) *= shrink;
    uw.row(i) *= shrink;
  }
}

template <class F>
double LogVolumeOf(const MovingParameters& moving, const DriftFilter& filter) noexcept {
  using Matrix = typename F::Matrix;
  const auto uw = F::Of(filter.uw);
  const auto ww = F::Of(filter.ww);
  const Eigen::LLT<Matrix> factor(F::Of(filter.uu));
  const Matrix root = factor.matrixL();
  const double of_u = HalfLogDeterminant(factor);
  if (moving.count == 0) return of_u;
  // Of the velocities given u: their covariance less what u tells of it.
  const auto told_of = [&](Eigen::Index velocity) noexcept {
    typename F::Vector told = uw.col(velocity);
    for (Eigen::Index i = 0; i < told.size(); ++i) {
      for (Eigen::Index k = 0; k < i; ++k) told[i] -= root(i, k) * told[k];
      told[i] /= root(i, i);
    }
    return told;
  };
  if (moving.count == 1)
    return of_u + 0.5 * std::log(ww(moving.first, moving.first) - told_of(moving.first).squaredNorm());
  Matrix told(uw.rows(), uw.cols());
  for (Eigen::Index j = 0; j < told.cols(); ++j) told.col(j) = told_of(j);
  const Matrix given_u = ww - told.transpose().lazyProduct(told);
  return of_u + HalfLogDeterminant(Eigen::LLT<Matrix>(given_u));
}

template <class F>
void AbsorbOf(const DriftFilter& other, double share, DriftFilter* filter) noexcept {
  using Vector = typename F::Vector;
  const double p = 1.0 - share;
  const double between = p * share;
  auto [u, w, uu, uw, ww] = PartsOf<F>(filter);
  const Vector apart = F::Of(other.u) - u;
  const Vector faster = F::Of(other.w) - w;
  const Vector by_apart = between * apart;
  const Vector by_faster = between * faster;
  uu = p * uu + share * F::Of(other.uu) + by_apart.lazyProduct(apart.transpose());
  uw = p * uw + share * F::Of(other.uw) + by_apart.lazyProduct(faster.transpose());
  ww = p * ww + share * F::Of(other.ww) + by_faster.lazyProduct(faster.transpose());
  u += share * apart;
  w += share * faster;
}

}  // namespace

double DriftFilter::MultiplyBy(const LocalLikelihood& local, const ParamVector& centre) noexcept {
  return WithFixedSize(u.size(), [&]<class F>(F) noexcept { return MultiplyByOf<F>(local, centre, this); });
}

double DriftFilter::ToEffective(const VelocityLikelihood& pack) noexcept {
  return WithFixedSize(u.size(), [&]<class F>(F) noexcept { return ToEffectiveOf<F>(pack, this); });
}

void DriftFilter::FromEffective(const ParamMatrix& lead) noexcept {
  WithFixedSize(u.size(), [&]<class F>(F) noexcept { FromEffectiveOf<F>(lead, this); });
}

void DriftFilter::Transform(const ParamMatrix& map, const ParamVector& from, const ParamVector& to) noexcept {
  WithFixedSize(u.size(), [&]<class F>(F) noexcept { TransformOf<F>(map, from, to, this); });
}

void DriftFilter::Propagate(const DriftStep& step, const MovingParameters& moving) noexcept {
  WithFixedSize(u.size(), [&]<class F>(F) noexcept { PropagateOf<F>(step, moving, this); });
}

double DriftFilter::LogVolume(const MovingParameters& moving) const noexcept {
  return WithFixedSize(u.size(), [&]<class F>(F) noexcept { return LogVolumeOf<F>(moving, *this); });
}

ARMCMC_TRUST_NONBLOCKING_END

void DriftFilter::Absorb(DriftFilter* other) noexcept {
  if (!(other->weight > 0.0)) return;
  const double whole = weight + other->weight;
  if (weight > 0.0) {
    const double share = other->weight / whole;
    WithFixedSize(u.size(), [&]<class F>(F) noexcept ARMCMC_NONBLOCKING { AbsorbOf<F>(*other, share, this); });
  } else {
    *this = *other;
  }
  weight = whole;
  other->weight = 0.0;
}

double KeptShare(double before, double grown) noexcept { return std::fmin(std::fmax(before, 1.0) / grown, 1.0); }

}  // namespace armcmc
