#pragma once

#include "armcmc/baselines/pack_filter.hpp"
#include "armcmc/laplace.hpp"
#include "armcmc/marginal_table.hpp"

namespace armcmc {

/// Plain MCMC: random-walk Metropolis-Hastings on likelihood x P_0 of each pack alone, as in the paper, without a
/// memory.
///
///   u* = u + c L z,  L L' = proposal covariance,  alpha = min(1, target(u*) / target(u))
///
/// A well-tuned random walk: it starts at the mode of the target (a bounded Gauss-Newton fit, so that no draw is
/// spent on the way there) with the covariance of the Laplace fit times 2.38^2 / dim; during burn-in, the first half,
/// the scale follows an acceptance of kAcceptance and the covariance that of the chain so far; then both are frozen.
class MetropolisFilter final : public PackFilter {
 public:
  static constexpr double kAcceptance = 0.3;
  static constexpr int kChunk = 64;  ///< Draws between two readings of the clock.

  explicit MetropolisFilter(const FilterParts& parts);
  Status Run(const ModeData& data, std::uint64_t pack, std::uint64_t mode, Nanos deadline_ns, ClockRef clock, int limit,
             ModeDraws* out) noexcept ARMCMC_NONBLOCKING override;
  void Reset() noexcept ARMCMC_NONBLOCKING override { known_ = false; }

 private:
  [[nodiscard]] double LogTarget(const ModeData& data, const ParamVector& u) noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] int Wanted() const noexcept ARMCMC_NONBLOCKING;

  FilterParts parts_;
  MarginalTable normal_table_;
  LaplaceScratch scratch_;
  std::array<std::array<double, kTileLanes>, kMaxParams> lanes_{};
  bool known_ = false;
};

}  // namespace armcmc
