#pragma once

#include <vector>

#include "armcmc/gap/effect_form.hpp"

namespace armcmc::gap {

/// Dead time, low pass of first and second order of the output sensor.
[[nodiscard]] std::vector<EffectForm> LatencyForms(const Signals& signals);
/// Clipping of the output sensor, hard and soft.
[[nodiscard]] std::vector<EffectForm> SaturationForms(const Signals& signals);

/// Unlisted: an output sensor that does not move for small outputs.
[[nodiscard]] EffectForm DeadZoneForm(const Signals& signals);

}  // namespace armcmc::gap
