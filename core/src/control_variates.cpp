#include "armcmc/control_variates.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/density_fit.hpp"
#include "armcmc/linear_algebra.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr double kLeastShare = 0.25;       // minimum share of the draws that is effective under g
constexpr int kLeastDrawsPerControl = 20;  // with fewer, lambda would be fitted to noise

constexpr int kMaxControls = kMaxParams + 1;  // without the quadratic ones
using ControlVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxControls, 1>;
using ControlMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxControls, kMaxControls>;

/// Sums over the draws of h and of h h', from the moments of u under the weights g and g^2.
struct ControlSums {
  ControlVector h;  ///< Of g - 1 and the linear controls.
  ControlMatrix hh;
  ParamMatrix second;            ///< sum g (u - m)(u - m)'.
  ParamMatrix second_squared;    ///< sum g^2 (u - m)(u - m)'.
  double square = 0.0;           ///< sum g^2.
  double effective_share = 0.0;  ///< Kish's, of g.
};

ParamMatrix FromLowerTriangle(const double* rows, int dim) noexcept ARMCMC_NONBLOCKING {
  ParamMatrix m(dim, dim);
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j <= i; ++j) m(i, j) = m(j, i) = *rows++;
  return m;
}

ControlSums Sum(const simd::Kernels& kernels, const ParamVector& mean, const ParamVector& sd,
                const ProposalDraws& draws, const double* g, const double* g_squared) noexcept ARMCMC_NONBLOCKING {
  const auto dim = static_cast<int>(mean.size());
  std::array<double, 2 + kMaxParams> first{}, first_squared{};
  std::array<double, kMaxParams*(kMaxParams + 1) / 2> second{}, second_squared{};
  kernels.first_moments(dim, draws.u.data(), g, draws.size, first.data());
  kernels.first_moments(dim, draws.u.data(), g_squared, draws.size, first_squared.data());
  kernels.second_moments(dim, draws.u.data(), g, mean.data(), draws.size, second.data());
  kernels.second_moments(dim, draws.u.data(), g_squared, mean.data(), draws.size, second_squared.data());
  const double n = draws.size, sum = first[0], square = first[1];
  ControlSums sums{.h = ControlVector(dim + 1),
                   .hh = ControlMatrix(dim + 1, dim + 1),
                   .second = FromLowerTriangle(second.data(), dim),
                   .second_squared = FromLowerTriangle(second_squared.data(), dim),
                   .square = square,
                   .effective_share = sum * sum / (n * square)};
  sums.h[0] = sum - n;
  sums.hh(0, 0) = square - 2.0 * sum + n;
  for (int i = 0; i < dim; ++i) {
    const auto at = static_cast<std::size_t>(2 + i);
    sums.h[1 + i] = (first[at] - mean[i] * sum) / sd[i];
    sums.hh(0, 1 + i) = sums.hh(1 + i, 0) = (first_squared[at] - mean[i] * square) / sd[i] - sums.h[1 + i];
    for (int j = 0; j <= i; ++j)
      sums.hh(1 + i, 1 + j) = sums.hh(1 + j, 1 + i) = sums.second_squared(i, j) / (sd[i] * sd[j]);
  }
  return sums;
}

double TraceOfProduct(const ParamMatrix& x, const ParamMatrix& y) noexcept ARMCMC_NONBLOCKING {
  double trace = 0.0;
  for (Eigen::Index i = 0; i < x.rows(); ++i)
    for (Eigen::Index j = 0; j < x.cols(); ++j) trace += x(i, j) * y(j, i);
  return trace;
}

/// sum h_q h_q' of the quadratic controls h_q = g (z z' - v I), in coordinates z in which G has the covariance v I. The
/// fourth moments under g^2 are taken to be those of a normal law with the second moments A that the draws have:
///
///   L -> square (2 A L A + B tr(B L)),   A = sum g^2 z z' / square,   B = A - v I,   square = sum g^2
class QuadraticBlock {
 public:
  QuadraticBlock(const ParamMatrix& second_squared, double square, double v) noexcept ARMCMC_NONBLOCKING
      : square_(square),
        b_(second_squared) {
    b_ *= 1.0 / square;
    inverse_ = Inverse(b_);
    for (Eigen::Index i = 0; i < b_.rows(); ++i) b_(i, i) -= v;
    of_b_ = Product(Product(inverse_, b_), inverse_);
    of_b_ *= 0.5;
  }
  /// sum g^2 (z z' - v I).
  [[nodiscard]] ParamMatrix Squared() const noexcept ARMCMC_NONBLOCKING {
    ParamMatrix m = b_;
    m *= square_;
    return m;
  }
  /// L of a symmetric right-hand side.
  [[nodiscard]] ParamMatrix Solve(const ParamMatrix& right) const noexcept ARMCMC_NONBLOCKING {
    ParamMatrix solution = Product(Product(inverse_, right), inverse_);
    solution *= 0.5 / square_;
    ParamMatrix correction = of_b_;
    correction *= TraceOfProduct(b_, solution) / (1.0 + TraceOfProduct(b_, of_b_));
    solution -= correction;
    return solution;
  }

 private:
  double square_;
  ParamMatrix b_, inverse_, of_b_;
};

// As in "armcmc/linear_algebra.hpp", for one unknown more than there are parameters.
ARMCMC_TRUST_NONBLOCKING_BEGIN
ControlVector Solve(const ControlMatrix& hh, const ControlVector& h) noexcept ARMCMC_NONBLOCKING {
  return hh.ldlt().solve(h);
}
ARMCMC_TRUST_NONBLOCKING_END

/// lambda of the quadratic controls, symmetric, for z = whiten (u - m). Of the others only h_0 is correlated with them:
/// G is symmetric.
ParamMatrix QuadraticCoefficients(const ControlSums& sums, const ParamMatrix& sum_q, const ParamMatrix& second_squared,
                                  double v) noexcept ARMCMC_NONBLOCKING {
  const QuadraticBlock block(second_squared, sums.square, v);
  ParamMatrix cross = block.Squared();  // of h_0 h_q
  cross -= sum_q;
  const ParamMatrix alone = block.Solve(sum_q), of_cross = block.Solve(cross);
  ControlVector h = sums.h;
  ControlMatrix hh = sums.hh;
  h[0] -= TraceOfProduct(cross, alone);
  hh(0, 0) -= TraceOfProduct(cross, of_cross);
  ParamMatrix lambda = of_cross;
  lambda *= -Solve(hh, h)[0];
  lambda += alone;
  return lambda;
}

}  // namespace

bool ReduceVariance(const simd::Kernels& kernels, const Gaussian& guide, const MarginalTable* table,
                    const ProposalDraws& draws, const std::array<double*, 2>& scratch) noexcept {
  const auto dim = static_cast<int>(guide.mean.size());
  if (draws.size < kLeastDrawsPerControl * (dim + 1)) return false;
  const ParamMatrix covariance = Inverse(guide.precision);
  ParamVector sd(dim);
  for (int d = 0; d < dim; ++d) {
    if (!(covariance(d, d) > 0.0) || !std::isfinite(covariance(d, d))) return false;
    sd[d] = std::sqrt(covariance(d, d));
  }
  DensityBlock block;
  SetElliptic(guide.mean, covariance, 1.0, table, &block);

  double* const g = scratch[0];
  double* const g_squared = scratch[1];
  const int padded = RoundUpToTile(draws.size);
  std::fill(g, g + padded, 0.0);
  for (int k = 0; k < draws.size; k += kTileLanes) kernels.add_density(block, draws.u.data(), k, 1.0, g + k);
  kernels.ratio(g, draws.proposal, padded, g);
  std::fill(g + draws.size, g + padded, 0.0);
  for (int k = 0; k < padded; ++k) g_squared[k] = g[k] * g[k];

  const ControlSums sums = Sum(kernels, guide.mean, sd, draws, g, g_squared);
  if (!(sums.effective_share >= kLeastShare)) return false;

  // 1 - lambda' h, the quadratic part first: 1 - g (y' Q y - v tr(lambda_q)),   y = u - m
  simd::QuadraticControl control{.dim = dim};
  for (int i = 0; i < dim; ++i) control.centre[i] = guide.mean[i];
  ControlVector h = sums.h;
  if (draws.size >= kLeastDrawsPerControl * (1 + dim + dim * (dim + 1) / 2)) {
    ParamMatrix whiten(dim, dim);
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j)
        whiten(i, j) = block.whiten[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    const auto whitened = [&](const ParamMatrix& m) noexcept ARMCMC_NONBLOCKING {
      return Product(Product(whiten, m), whiten.transpose());
    };
    const double v = table->Variance();
    ParamMatrix sum_q = whitened(sums.second);
    for (int i = 0; i < dim; ++i) sum_q(i, i) -= v * (sums.h[0] + draws.size);
    const ParamMatrix lambda_q = QuadraticCoefficients(sums, sum_q, whitened(sums.second_squared), v);
    if (!lambda_q.allFinite()) return false;
    const ParamMatrix q = Product(Product(whiten.transpose(), lambda_q), whiten);
    for (int i = 0; i < dim; ++i) {
      control.constant -= v * lambda_q(i, i);
      for (int j = 0; j <= i; ++j) control.curvature[i][j] = i == j ? q(i, i) : q(i, j) + q(j, i);
    }
    // What it leaves to the linear controls, exactly: their third moments with the quadratic ones are not zero.
    double* const left = g_squared;
    std::copy(g, g + padded, left);
    (void)kernels.reweigh(control, draws.u.data(), g, padded, left);
    std::array<double, 2 + kMaxParams> first{};
    kernels.first_moments(dim, draws.u.data(), left, draws.size, first.data());
    h[0] = first[0] - draws.size + TraceOfProduct(lambda_q, sum_q);
    for (int i = 0; i < dim; ++i)
      h[1 + i] = (first[static_cast<std::size_t>(2 + i)] - guide.mean[i] * first[0]) / sd[i];
  }
  const ControlVector lambda = Solve(sums.hh, h);
  if (!lambda.allFinite()) return false;
  control.most += lambda[0];
  control.constant += lambda[0];
  for (int i = 0; i < dim; ++i) control.slope[i] = lambda[1 + i] / sd[i];
  const double total = kernels.reweigh(control, draws.u.data(), g, padded, draws.weight);
  kernels.divide(draws.weight, total, padded, draws.weight);
  return true;
}

}  // namespace armcmc
