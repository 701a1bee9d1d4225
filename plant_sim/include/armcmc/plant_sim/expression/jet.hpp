#pragma once

#include <array>
#include <vector>

#include "armcmc/plant_sim/expression/tree.hpp"

namespace armcmc::plant_sim::expression {

/// A quantity and its first three derivatives with respect to time.
using Jet = std::array<double, 4>;

/// f(u) from f and its derivatives at u[0] (Faa di Bruno).
[[nodiscard]] Jet Compose(const Jet& f, const Jet& u);

/// Value and exact derivatives of an expression of time.
/// @param values  By place, as an Expression was bound. @param time  Place of t; all others are constant.
/// Where a kink is (abs, sign, min, max, clamp, step, if), the derivatives are those of the branch that is taken.
/// @throws Error at a function with memory.
[[nodiscard]] Jet Differentiate(const Tree& node, const std::vector<double>& values, int time);

}  // namespace armcmc::plant_sim::expression
