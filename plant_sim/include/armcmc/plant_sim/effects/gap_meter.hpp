#pragma once

#include <memory>
#include <vector>

#include "armcmc/plant_sim/effects/hidden_effect.hpp"
#include "armcmc/plant_sim/scenario.hpp"

namespace armcmc::plant_sim {

/// Measures on a noise-free run of a scenario how visible effects are: the gap ratio
///
///   R = rms over the run of (output with the effects - base law refitted to it) / sd of the output's noise
///
/// Refitted means a constant correction of every base parameter, by least squares. What the base can absorb is not a
/// gap, and neither is what the law itself errs by: an effect is as strong in a plant with a LawError as in one
/// without.
class GapMeter {
 public:
  virtual ~GapMeter() = default;
  [[nodiscard]] virtual double GapRatio(const std::vector<HiddenEffect>& effects) const = 0;
  [[nodiscard]] virtual const EffectScales& scales() const = 0;
};

/// Long runs are judged by this many first samples.
inline constexpr long long kMaxGapSamples = 200'000;

/// @throws std::invalid_argument when the family offers no effects, its output has no noise to compare with, or the
///         run stands still or leaves the finite range.
[[nodiscard]] std::unique_ptr<GapMeter> MakeGapMeter(const Scenario& scenario);

/// Sets the strength of an effect, its first parameter, such that its gap ratio is `gap_ratio` to 1 %: upwards from the
/// weakest end of its range to a crossing, then secants, both in logarithms. At most 81 refits, usually 4 to 8.
/// @return false when no strength in the range gives that ratio; the
/// effect is then unusable.
[[nodiscard]] bool FindStrength(const GapMeter& meter, double gap_ratio, HiddenEffect* effect);

}  // namespace armcmc::plant_sim
