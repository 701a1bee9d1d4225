#pragma once

#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/result.hpp"

namespace armcmc::gap {

/// The second step: where the base model and the data disagree, largest effect first.
///
/// For each variable: the share of the noise variance that it alone predicts on blocks left out, with a p-value by the
/// bootstrap over blocks. For each region of a tree of depth three over mode, depth, speed, acceleration and time: its
/// share of the squared error beyond the noise, with a p-value by shifting the error in time against the inputs, which
/// preserves its autocorrelation.
/// @param seed  Seed of the shifts.
[[nodiscard]] std::vector<Where> FindWhere(const Equation& equation, const Analysis& analysis,
                                           const BlockBootstrap& bootstrap, unsigned long long seed);

}  // namespace armcmc::gap
