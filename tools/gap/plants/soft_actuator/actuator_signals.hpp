#pragma once

#include "armcmc/gap/recording.hpp"
#include "armcmc/gap/signals.hpp"
#include "plants/soft_actuator/constants.hpp"

namespace armcmc::gap {

/// Time, valves and pressure of an actuator recording; no output yet.
///
/// The pressure is smoothed without rounding the corners where a valve opens: the integral of p' is subtracted, which
/// has the corners, what is left is smoothed widely, and the integral is added again.
/// @param window  Samples of the smoother of the workflow; the wide one here is a multiple of it.
[[nodiscard]] Signals ActuatorSignals(const Recording& recording, int window, const ActuatorConstants& constants);

/// sign(dp) sqrt|dp| of the valve that a signed opening opens; sqrt(Pa).
[[nodiscard]] double ValveHead(double opening, double gauge_pressure, const ActuatorConstants& constants);

}  // namespace armcmc::gap
