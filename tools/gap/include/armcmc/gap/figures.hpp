#pragma once

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/result.hpp"

namespace armcmc::gap {

/// Everything that the report plots, from the fits of the diagnosis.
[[nodiscard]] Figures MakeFigures(const Equation& equation, const Signals& signals, const Analysis& analysis,
                                  const Fitted& before, const Fitted& after);

}  // namespace armcmc::gap
