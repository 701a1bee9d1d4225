#include "armcmc/plant_sim/effects/gap_meter.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace armcmc::plant_sim {

std::unique_ptr<GapMeter> MakeGapMeter(const Scenario& scenario) {
  if (EffectRegistry(*scenario.family).empty())
    throw std::invalid_argument("no effects can be hidden in a plant of the family " + scenario.family->name);
  // What the law itself errs by is a gap, too, but none of the effects'.
  Scenario exact = scenario;
  exact.options.Set("error", 0.0);
  return scenario.family->make_gap_meter(exact);
}

bool FindStrength(const GapMeter& meter, double gap_ratio, HiddenEffect* effect) {
  const EffectParameter& strength = effect->spec->parameters.front();
  const double scale = meter.scales()[static_cast<std::size_t>(strength.scale)];
  const double sign = effect->values.front() < 0.0 ? -1.0 : 1.0;
  const auto measure = [&](double share) {
    effect->values.front() = sign * scale * strength.lo * std::pow(strength.hi / strength.lo, share);
    return effect->gap_ratio = meter.GapRatio({*effect});
  };
  const auto hit = [&] { return std::abs(effect->gap_ratio - gap_ratio) <= 0.01 * gap_ratio; };

  if (measure(0.0) > gap_ratio) return hit();
  const double span = std::log(strength.hi / strength.lo);
  double below = 0.0, above = -1.0, log_below = std::log(effect->gap_ratio / gap_ratio), log_above = 0.0;
  // Upwards: a gap is nearly proportional to its strength, so that the ratio that is missing is the step to take; never
  // more than a third of the range, because a gap may also come down again.
  constexpr int kMaxUp = 30, kMaxIn = 50;
  constexpr double kLongest = 1.0 / 3.0, kShortest = 1.0 / 30.0;
  for (int i = 0; i < kMaxUp && above < 0.0 && below < 1.0; ++i) {
    const double step = std::clamp(1.05 * std::abs(log_below / span), kShortest, kLongest);
    const double share = std::min(below + (std::isfinite(step) ? step : kShortest), 1.0);
    const double log_ratio = std::log(measure(share) / gap_ratio);
    if (hit()) return true;
    (log_ratio < 0.0 ? below : above) = share;
    (log_ratio < 0.0 ? log_below : log_above) = log_ratio;
  }
  // Inwards: the secant in logarithms, every third time the middle, which an S-shaped curve needs.
  for (int i = 0; i < kMaxIn && above >= 0.0 && !hit(); ++i) {
    const double secant = below + (above - below) * log_below / (log_below - log_above);
    const bool usable = std::isfinite(secant) && i % 3 != 2;
    const double share = usable ? secant : 0.5 * (below + above);
    const double log_ratio = std::log(measure(share) / gap_ratio);
    (log_ratio < 0.0 ? below : above) = share;
    (log_ratio < 0.0 ? log_below : log_above) = log_ratio;
  }
  return hit();
}

}  // namespace armcmc::plant_sim
