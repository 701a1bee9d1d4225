#pragma once

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/result.hpp"
#include "armcmc/gap/verify.hpp"

namespace armcmc::gap {

/// Gap relative to the noise on held-out data, below which they confirm nothing.
inline constexpr double kUnseenRatio = 0.15;

/// Held-out data may withdraw a name but never add one: a hypothesis that does not hold on them is replaced by another
/// formula of the same effects, or withdrawn.
void Confirm(const Equation& equation, const HeldOut& heldout, const DiagnoseOptions& options, Diagnosis* diagnosis,
             Result* result);

}  // namespace armcmc::gap
