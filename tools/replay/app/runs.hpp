#pragma once

#include "arguments.hpp"

namespace armcmc::replay {

/// The jobs of the program; each returns the exit code.
[[nodiscard]] int RunEstimates(const Arguments& arguments);    ///< Estimates, --verify.
[[nodiscard]] int RunComparison(const Arguments& arguments);   ///< --compare, --compare-model.
[[nodiscard]] int RunCalibration(const Arguments& arguments);  ///< --calibrate.

}  // namespace armcmc::replay
