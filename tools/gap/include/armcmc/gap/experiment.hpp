#pragma once

#include <string>
#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/result.hpp"

namespace armcmc::gap {

/// The experiment of the library that would separate the candidates best.
///
/// For each motion and each pair of candidates, one is simulated at its estimate and the other refitted to it; what
/// stays is the evidence that the motion would bring:  D = min_theta |f_i - f_j(theta)|^2 / (2 s2), whitened. The
/// motion wins that decides most pairs, D / (D + 10 nats) each, weighted by the probabilities of both: a pair that no
/// motion separates does not keep the others from being separated.
/// @return words and nats; `scenario_file` is left to the caller.
[[nodiscard]] Experiment SeparatingExperiment(const Equation& equation, const Look& look,
                                              const std::vector<CandidatePtr>& candidates);

/// The plant's scenario file for that experiment.
[[nodiscard]] std::string ScenarioText(const Equation& equation, const Look& look, const Experiment& experiment);

}  // namespace armcmc::gap
