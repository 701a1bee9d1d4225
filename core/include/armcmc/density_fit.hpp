#pragma once

#include <array>

#include "armcmc/density_block.hpp"
#include "armcmc/linear_algebra.hpp"
#include "armcmc/marginal_table.hpp"
#include "armcmc/nonblocking.hpp"

namespace armcmc {

namespace simd {
struct Kernels;
}

/// Makes `block` a product law around `mean` with covariance shape C: sd of marginal i along principal axis i, times
/// `inflation`. Falls back to the diagonal of C where C has no eigenvalues. @rt bounded, no heap.
void SetElliptic(const ParamVector& mean, const ParamMatrix& covariance, double inflation, const MarginalTable* table,
                 DensityBlock* block) noexcept ARMCMC_NONBLOCKING;

/// Makes `block` axis aligned and centred, coordinate i with law tables[i].
void SetAxisAligned(int dim, const std::array<const MarginalTable*, kMaxParams>& tables,
                    DensityBlock* block) noexcept ARMCMC_NONBLOCKING;

/// Mean and covariance of the law that a block was fitted to (before bending and tails).
[[nodiscard]] ParamVector MeanOf(const DensityBlock& block) noexcept ARMCMC_NONBLOCKING;
[[nodiscard]] ParamMatrix CovarianceOf(const DensityBlock& block) noexcept ARMCMC_NONBLOCKING;

/// Weighted draws in structure-of-arrays form; element d of `u` points to one coordinate of all draws. Arrays are
/// padded to a multiple of kTileLanes with finite coordinates and weight 0.
struct WeightedDraws {
  int dim = 0;
  int size = 0;
  std::array<const double*, kMaxParams> u{};
  const double* weight = nullptr;  ///< >= 0, need not sum to 1.
};

struct FitOptions {
  double bandwidth_factor = 1.0;  ///< Times the normal-reference bandwidth 1.06 ESS^(-1/5).
  double tail_weight = 0.05;      ///< Share of a normal law mixed into every marginal, so that no tail is empty.
  double tail_sd = 1.25;          ///< Its standard deviation.
  double inflation = 1.0;         ///< Of every standard deviation, for use as a proposal.
  bool shrink_to_normal = false;  ///< Marginals keep of their shape what is beyond sampling error.
  double mean_freedom = 1.0;      ///< Degrees of freedom that sums of squares lose to the mean; 0 where control
                                  ///< variates hold mean and covariance, see ReduceVariance().
};

/// Fits a block to weighted draws. The straightened coordinates get exactly the mean and standard deviation of the
/// draws (times inflation): smoothing and tails are compensated, so that repeated compression does not widen a
/// posterior.
///
/// @param scratch kMaxParams + 2 rows as long as the draws (rows past dim may be null, the last two may not).
/// @param tables  Storage for the marginals, dim entries; must outlive the block.
/// @return Kish effective sample size of the weights; below kMinimumEss nothing was written.
/// @rt No heap, no lock, no throw. O(size dim^2).
double FitBlock(const simd::Kernels& kernels, const WeightedDraws& draws, const FitOptions& options,
                double* const* scratch, MarginalTable* tables, DensityBlock* block) noexcept ARMCMC_NONBLOCKING;
inline constexpr double kMinimumEss = 30.0;

/// Gives a block one coordinate more, after the others and independent of them: mean + sd x, x by `law` standardised.
/// @param table  Storage for its marginal; must outlive the block.
/// @rt No heap, no lock, no throw. O(nodes).
void AppendIndependent(double mean, double sd, const MarginalTable& law, MarginalTable* table,
                       DensityBlock* block) noexcept ARMCMC_NONBLOCKING;

}  // namespace armcmc
