#pragma once

#include <cstdint>
#include <memory>

#include "armcmc/adjust_result.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/noise_model.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/parameter_space.hpp"
#include "armcmc/settings.hpp"
#include "armcmc/status.hpp"

namespace armcmc {

namespace simd {
struct Kernels;
}

/// One step of a baseline on one mode. It fills the same ModeDraws as the ARMCMC sampler, so that summary, prediction,
/// messages and replay are independent of the method.
class PackFilter {
 public:
  virtual ~PackFilter() = default;

  /// @param data   At least forgetting.min_samples samples of the mode.
  /// @param pack   Number of the pack; selects the random stream.
  /// @param limit  Upper bound on the draws, to repeat a truncated run (Metropolis only).
  /// @return kOk, kTruncated (Metropolis only) or kNonFinite (nothing was learnt).
  /// @rt No heap, no lock, no throw, bounded.
  virtual Status Run(const ModeData& data, std::uint64_t pack, std::uint64_t mode, Nanos deadline_ns, ClockRef clock,
                     int limit, ModeDraws* out) noexcept ARMCMC_NONBLOCKING = 0;
  /// The mode becomes active again after another one.
  virtual void Resume() noexcept ARMCMC_NONBLOCKING {}
  /// Forgets everything.
  virtual void Reset() noexcept ARMCMC_NONBLOCKING = 0;
};

/// What a filter of one mode is built from. References outlive it.
struct FilterParts {
  const simd::Kernels& kernels;
  int model;
  const EstimatorSettings& settings;
  ParameterSpace space;
  NoiseModel noise;
};

/// The filter of settings.method. @pre That is not kArmcmc. Allocates.
[[nodiscard]] std::unique_ptr<PackFilter> MakeFilter(const FilterParts& parts);

/// Writes what all baselines share: the numbers of the step, and that there was no decision.
void FillStep(const ModeData& data, int draws, int burn_in, ModeDraws* out) noexcept ARMCMC_NONBLOCKING;

/// Whether weighted draws determine any parameter better than its prior, by the rule of the ARMCMC estimator.
[[nodiscard]] bool IsInformed(const ParameterSpace& space, const ModeDraws& draws) noexcept ARMCMC_NONBLOCKING;

}  // namespace armcmc
