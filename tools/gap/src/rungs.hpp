#pragma once

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/result.hpp"
#include "armcmc/gap/verify.hpp"

namespace armcmc::gap {

/// Writes what was found as a ladder: of several effects the one that explains most by itself first, then what the
/// others take off; behind them whether anything is left. Of a plant with several equations the one that is diagnosed.
/// @pre The gap of the result is filled in.
void WriteRungs(const Equation& equation, const HeldOut& heldout, const Diagnosis& diagnosis, Result* result);

}  // namespace armcmc::gap
