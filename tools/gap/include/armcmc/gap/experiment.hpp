#pragma once

#include <string>
#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/result.hpp"

namespace armcmc::gap {

/// The experiment of the library that would separate the candidates best.
///
/// For each motion and each pair of candidates, one is simulated at its estimate and the other refitted to it; the
/// expected evidence of the motion is  D = min_theta |f_i - f_j(theta)|^2 / (2 s^2), whitened. The motion with the
/// largest sum of D / (D + 10 nats), weighted by the probabilities of both candidates, is chosen: a pair that no motion
/// separates does not affect the choice for the others.
/// @return words and nats; the caller sets `scenario_file`.
[[nodiscard]] Experiment SeparatingExperiment(const Equation& equation, const Analysis& analysis,
                                              const std::vector<CandidatePtr>& candidates);

/// The plant's scenario file for that experiment.
[[nodiscard]] std::string ScenarioText(const Equation& equation, const Analysis& analysis,
                                       const Experiment& experiment);

}  // namespace armcmc::gap
