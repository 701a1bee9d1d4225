#pragma once

#include <vector>

#include "armcmc/gap/effect_form.hpp"

namespace armcmc::gap {

/// An amplitude with a normal prior whose sd is a fifth of `unit_size`; not negative if the physics has a sign.
[[nodiscard]] Coordinate AmplitudeOf(const char* name, const char* unit, double unit_size, bool has_sign,
                                     double sd = 0.2, double upper = 3.0);
/// A length, speed, time or opening: log-normal around the middle of its range, given in multiples of `unit_size`.
[[nodiscard]] Coordinate ShapeOf(const char* name, const char* unit, double unit_size, double lower, double upper);
/// Starts with amplitudes of zero, over a grid of all shapes: counts[i] values of the i-th shape.
void SetStarts(EffectForm* form, const std::vector<int>& counts);
/// Unnamed physics that competes with the effects of the catalogue.
[[nodiscard]] EffectForm UnlistedForm(const char* what, const char* family, const char* formula, Slot slot);

}  // namespace armcmc::gap
