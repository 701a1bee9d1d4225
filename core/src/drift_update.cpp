// Bayes' rule for parameters and their velocities together.
#include <algorithm>
#include <array>
#include <cmath>

#include "armcmc/drift.hpp"

namespace armcmc {
namespace {

constexpr std::size_t kMost = 2 * kMaxParams;

/// A matrix of parameters and velocities: what Eigen's bounded sizes would be, without their code.
struct Joint {
  std::size_t size = 0;
  std::array<std::array<double, kMost>, kMost> at;
};

/// L of A = L L', the lower half of A being read. @return false where A is not positive definite.
bool Factor(const Joint& a, Joint* l) noexcept {
  l->size = a.size;
  for (std::size_t i = 0; i < a.size; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = a.at[i][j];
      for (std::size_t k = 0; k < j; ++k) sum -= l->at[i][k] * l->at[j][k];
      if (i == j && !(sum > 0.0)) return false;
      l->at[i][j] = i == j ? std::sqrt(sum) : sum / l->at[j][j];
    }
  return true;
}

/// I + L' H L, lower half.
Joint Spread(const Joint& l, const Joint& h) noexcept {
  Joint product{.size = l.size, .at = {}};  // H L
  for (std::size_t i = 0; i < l.size; ++i)
    for (std::size_t j = 0; j < l.size; ++j)
      for (std::size_t k = j; k < l.size; ++k) product.at[i][j] += h.at[i][k] * l.at[k][j];
  Joint spread{.size = l.size, .at = {}};
  for (std::size_t i = 0; i < l.size; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      spread.at[i][j] = i == j ? 1.0 : 0.0;
      for (std::size_t k = i; k < l.size; ++k) spread.at[i][j] += l.at[k][i] * product.at[k][j];
    }
  return spread;
}

/// L (M M')^-1 L'.
Joint Shrunk(const Joint& l, const Joint& m) noexcept {
  Joint x{.size = l.size, .at = {}};  // M^-1 L', by rows
  for (std::size_t i = 0; i < l.size; ++i)
    for (std::size_t j = 0; j < l.size; ++j) {
      double sum = j >= i ? l.at[j][i] : 0.0;
      for (std::size_t k = 0; k < i; ++k) sum -= m.at[i][k] * x.at[k][j];
      x.at[i][j] = sum / m.at[i][i];
    }
  Joint shrunk{.size = l.size, .at = {}};
  for (std::size_t i = 0; i < l.size; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      for (std::size_t k = 0; k < l.size; ++k) shrunk.at[i][j] += x.at[k][i] * x.at[k][j];
      shrunk.at[j][i] = shrunk.at[i][j];
    }
  return shrunk;
}

/// log det of M M'.
double LogDeterminant(const Joint& m) noexcept {
  double product = 1.0;
  for (std::size_t i = 0; i < m.size; ++i) product *= m.at[i][i];
  return 2.0 * std::log(product);
}

void SetBlocks(const ParamMatrix& uu, const ParamMatrix& uw, const ParamMatrix& ww, Joint* joint) noexcept {
  const auto dim = static_cast<std::size_t>(uu.rows());
  joint->size = 2 * dim;
  for (std::size_t i = 0; i < dim; ++i)
    for (std::size_t j = 0; j < dim; ++j) {
      const auto row = static_cast<Eigen::Index>(i);
      const auto column = static_cast<Eigen::Index>(j);
      joint->at[i][j] = uu(row, column);
      joint->at[i][dim + j] = joint->at[dim + j][i] = uw(row, column);
      joint->at[dim + i][dim + j] = ww(row, column);
    }
}

}  // namespace

double Drift::LogVolume(const Filter& filter, bool moves) noexcept {
  if (!(filter.weight > 0.0)) return 0.0;
  Joint covariance, root;
  SetBlocks(filter.uu, filter.uw, filter.ww, &covariance);
  if (!moves) covariance.size /= 2;
  return Factor(covariance, &root) ? LogDeterminant(root) : 0.0;
}

double Drift::Observe(const LocalLikelihood& local, const ParamVector& about, bool moves, Filter* filter) noexcept {
  const double log_evidence = moves ? ObserveMoving(local, about, filter) : ObserveStill(local, about, filter);
  const Filter& f = *filter;
  const bool finite = f.u.allFinite() && f.w.allFinite() && f.uu.allFinite() && f.uw.allFinite() && f.ww.allFinite();
  return finite && std::isfinite(log_evidence) ? log_evidence : std::nan("");
}

double Drift::ObserveStill(const LocalLikelihood& local, const ParamVector& about, Filter* filter) noexcept {
  Filter& f = *filter;
  // P = C (1 + H C)^-1, and w is updated through its covariance with u.
  ParamMatrix spread = Product(local.information, f.uu);
  for (Eigen::Index i = 0; i < spread.rows(); ++i) spread(i, i) += 1.0;
  const ParamMatrix t = Inverse(spread);
  const ParamVector apart = f.u - about;
  const ParamVector pulled = Multiply(local.information, apart);
  const ParamVector residual = local.gradient - pulled;
  const ParamVector step = Multiply(t, residual);
  const ParamVector move = Multiply(f.uu, step);
  const double log_evidence = local.gradient.dot(apart) - 0.5 * apart.dot(pulled) + 0.5 * residual.dot(move) -
                              0.5 * std::log(std::fmax(Determinant(spread), 1e-300));
  f.u += move;
  f.w += Multiply(f.uw.transpose(), step);
  f.ww -= Product(Product(f.uw.transpose(), Product(t, local.information)), f.uw);
  f.uw = Product(t.transpose(), f.uw);
  f.uu = Product(f.uu, t);
  MakeSymmetric(&f.uu);
  MakeSymmetric(&f.ww);
  return log_evidence;
}

double Drift::ObserveMoving(const LocalLikelihood& local, const ParamVector& about, Filter* filter) noexcept {
  Filter& f = *filter;
  const Eigen::Index dim = f.u.size();
  Joint before, h, root, m;
  SetBlocks(f.uu, f.uw, f.ww, &before);
  SetBlocks(local.information, local.cross_information, local.speed_information, &h);
  const std::size_t size = before.size;
  if (!Factor(before, &root) || !Factor(Spread(root, h), &m)) return std::nan("");
  const Joint after = Shrunk(root, m);
  // z = (u - about, w), and what pulls it: g - H z.
  std::array<double, kMost> z{}, pull{};
  for (Eigen::Index i = 0; i < dim; ++i) {
    const auto at = static_cast<std::size_t>(i);
    z[at] = f.u[i] - about[i];
    pull[at] = local.gradient[i];
    z[at + static_cast<std::size_t>(dim)] = f.w[i];
    pull[at + static_cast<std::size_t>(dim)] = local.speed_gradient[i];
  }
  double log_evidence = -0.5 * LogDeterminant(m);
  for (std::size_t i = 0; i < size; ++i) {
    double held = 0.0;
    for (std::size_t j = 0; j < size; ++j) held += h.at[i][j] * z[j];
    log_evidence += z[i] * (pull[i] - 0.5 * held);
    pull[i] -= held;
  }
  std::array<double, kMost> step{};
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) step[i] += after.at[i][j] * pull[j];
    log_evidence += 0.5 * pull[i] * step[i];
  }
  for (Eigen::Index i = 0; i < dim; ++i) {
    const auto r = static_cast<std::size_t>(i);
    const auto wr = r + static_cast<std::size_t>(dim);
    f.u[i] += step[r];
    f.w[i] += step[wr];
    for (Eigen::Index j = 0; j < dim; ++j) {
      const auto c = static_cast<std::size_t>(j);
      const auto wc = c + static_cast<std::size_t>(dim);
      f.uu(i, j) = after.at[r][c];
      f.uw(i, j) = after.at[r][wc];
      f.ww(i, j) = after.at[wr][wc];
    }
  }
  return log_evidence;
}

bool Drift::Drifts(const PosteriorMemory& memory, int block) const noexcept {
  if (&memory != &carried_) return false;
  return split_ ? block == drifting_block_ : CarriedPart() == Part::kDrift;
}

bool Drift::LetDrift(const LocalLikelihood& local, Gaussian* fit, DriftFactor* factor) const noexcept {
  // w given u, before the pack.
  const ParamMatrix regression = Product(drifting_.uw.transpose(), Inverse(drifting_.uu));
  ParamMatrix root;
  if (!regression.allFinite() || !CholeskyFactor(drifting_.ww - Product(regression, drifting_.uw), &root)) return false;
  const SymmetricEigen eigen = EigenOfSymmetric(Product(Product(root.transpose(), local.speed_information), root));
  if (!eigen.converged) return false;
  const ParamMatrix whiten = Product(eigen.vectors.transpose(), root.transpose());
  Filter after = drifting_;
  if (std::isnan(Observe(local, fit->mean.head(dim_), true, &after))) return false;
  ParamMatrix covariance = Inverse(fit->precision);
  covariance.topLeftCorner(dim_, dim_) = after.uu;
  const ParamMatrix precision = Inverse(covariance);
  if (!precision.allFinite()) return false;
  fit->mean.head(dim_) = after.u;
  fit->precision = precision;
  factor->dim = dim_;
  for (int i = 0; i < dim_; ++i) {
    factor->speed[i] = drifting_.w[i];
    factor->place[i] = drifting_.u[i];
    factor->gain[i] = std::fmax(eigen.values[i], 0.0);
    for (int j = 0; j < dim_; ++j) {
      factor->regression[i][j] = regression(i, j);
      factor->information[i][j] = local.speed_information(i, j);
      factor->whiten[i][j] = whiten(i, j);
    }
  }
  return true;
}

}  // namespace armcmc
