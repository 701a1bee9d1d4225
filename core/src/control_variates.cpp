#include "armcmc/control_variates.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/density_fit.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr double kLeastShare = 0.25;       // minimum share of the draws that is effective under g
constexpr int kLeastDrawsPerControl = 20;  // with fewer, lambda would be fitted to noise

constexpr int kMaxControls = kMaxParams + 1;
using ControlVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxControls, 1>;
using ControlMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxControls, kMaxControls>;

/// Sums over the draws of h and of h h', from the moments of u under the weights g and g^2.
struct ControlSums {
  ControlVector h;
  ControlMatrix hh;
  double effective_share = 0.0;  ///< Kish's, of g.
};

ControlSums Sum(const simd::Kernels& kernels, const ParamVector& mean, const ParamVector& sd,
                const ProposalDraws& draws, const double* g, const double* g_squared) noexcept ARMCMC_NONBLOCKING {
  const auto dim = static_cast<int>(mean.size());
  std::array<double, 2 + kMaxParams> first{}, first_squared{};
  std::array<double, kMaxParams*(kMaxParams + 1) / 2> second{};
  kernels.first_moments(dim, draws.u.data(), g, draws.size, first.data());
  kernels.first_moments(dim, draws.u.data(), g_squared, draws.size, first_squared.data());
  kernels.second_moments(dim, draws.u.data(), g_squared, mean.data(), draws.size, second.data());
  const double n = draws.size, sum = first[0], square = first[1];
  ControlSums sums{ControlVector(dim + 1), ControlMatrix(dim + 1, dim + 1), sum * sum / (n * square)};
  sums.h[0] = sum - n;
  sums.hh(0, 0) = square - 2.0 * sum + n;
  std::size_t t = 0;
  for (int i = 0; i < dim; ++i) {
    const auto at = static_cast<std::size_t>(2 + i);
    sums.h[1 + i] = (first[at] - mean[i] * sum) / sd[i];
    sums.hh(0, 1 + i) = sums.hh(1 + i, 0) = (first_squared[at] - mean[i] * square) / sd[i] - sums.h[1 + i];
    for (int j = 0; j <= i; ++j) sums.hh(1 + i, 1 + j) = sums.hh(1 + j, 1 + i) = second[t++] / (sd[i] * sd[j]);
  }
  return sums;
}

// As in "armcmc/linear_algebra.hpp", for one unknown more than there are parameters.
ARMCMC_TRUST_NONBLOCKING_BEGIN
ControlVector Coefficients(const ControlSums& sums) noexcept ARMCMC_NONBLOCKING { return sums.hh.ldlt().solve(sums.h); }
ARMCMC_TRUST_NONBLOCKING_END

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
  const ControlVector lambda = Coefficients(sums);
  if (!lambda.allFinite()) return false;

  // 1 - lambda' h = (1 + lambda_0) - g (lambda_0 + sum_d lambda_d (u_d - m_d) / s_d)
  simd::LinearControl control{.dim = dim, .most = 1.0 + lambda[0], .constant = lambda[0]};
  for (int d = 0; d < dim; ++d) {
    control.slope[d] = lambda[1 + d] / sd[d];
    control.constant -= control.slope[d] * guide.mean[d];
  }
  const double total = kernels.reweigh(control, draws.u.data(), g, padded, draws.weight);
  kernels.divide(draws.weight, total, padded, draws.weight);
  return true;
}

}  // namespace armcmc
