#pragma once

#include <memory>
#include <string>
#include <vector>

#include "armcmc/gap/equation.hpp"
#include "plants/soft_actuator/constants.hpp"

namespace armcmc::gap {

/// Valve flow of the actuator, as the pressure rate that it predicts:
///
///   p' = v sign(dp) sqrt|dp| / (g + theta2 (p - p_atm)),   v = u_c, dp = p_s - p while filling,
///                                                          v = u_d, dp = p - p_atm while venting
///
/// The noise of p' is then the noise of the output, and white; as the regression u s sqrt|dp| = p' (g + theta2 (p -
/// p_atm)) that the estimator uses it is an error in the variables. Coordinates: g and theta2 of each valve.
/// Columns t, u_c, u_d, p, pdot.
/// @param model  Built-in name: its constants p_atm and p_supply are known.
[[nodiscard]] std::unique_ptr<Equation> MakeFlowEquation(const std::string& model);

/// Angle of the actuator, simulated from the measured pressure:
///
///   alpha'' = q1 (p - p_atm) - q2 alpha' - q3 alpha
///
/// An output error: the law low-passes what noise the smoothed pressure has left, and the noise of alpha stays white,
/// which two derivatives of alpha would not leave it. q1, q2, q3 are constants of the model, and the state at
/// the start is that of the data: there are no coordinates.
/// Columns t, u_c, u_d, p, pdot, alpha.
[[nodiscard]] std::unique_ptr<Equation> MakeBendEquation(const std::string& model);

/// The motion of the plant's library that separates the candidates best, by rules; without candidates, the one that
/// excites the flow law.
[[nodiscard]] Experiment ActuatorExperiment(const std::string& plant, const Signals& signals,
                                            const ActuatorConstants& constants,
                                            const std::vector<CandidatePtr>& candidates);

}  // namespace armcmc::gap
