#pragma once

#include <memory>
#include <string>

#include "armcmc/gap/equation.hpp"

namespace armcmc::gap {

/// Force of a contact (Hunt and Crossley 1975):  f = x^p (K + B v)  for x > 0, else 0.
///
/// Columns t, x, v, f. Coordinates: force k at the rms depth and damping b at the rms speed, both over the rms force,
/// and p:  f = F (x / X)^p (k + b v / V),  so that K = F k / X^p and B = F b / (X^p V).
[[nodiscard]] std::unique_ptr<Equation> MakeContactEquation(const std::string& plant);

}  // namespace armcmc::gap
