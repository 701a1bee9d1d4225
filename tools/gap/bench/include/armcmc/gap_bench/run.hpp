#pragma once

#include <functional>
#include <vector>

#include "armcmc/gap_bench/case.hpp"
#include "armcmc/gap_bench/plant.hpp"

namespace armcmc::gap_bench {

/// Makes a recording, diagnoses it without the sealed file, then opens that and scores.
/// Whatever goes wrong is kFailed, with the reason.
/// @param keep  Whether recordings and sealed files stay.
[[nodiscard]] Outcome RunCase(const PlantProcess& plant, const Case& what, bool keep);

/// Runs cases on `jobs` threads. `done` is called with each as it ends, one at a time.
[[nodiscard]] std::vector<Outcome> RunCases(const PlantProcess& plant, const std::vector<Case>& cases, int jobs,
                                            bool keep, const std::function<void(const Outcome&)>& done);

/// Whether an answer is a tie that an experiment could resolve: the effects are the catalogue's own.
[[nodiscard]] bool CanFollowUp(const Outcome& outcome);
/// For an ambiguous answer: the experiment that the tool proposes, made with the plant and the effect of the case, both
/// as the sealed file tells them. The scenario file is written to the plant's folder.
[[nodiscard]] Case FollowUp(const PlantProcess& plant, const Outcome& outcome);

}  // namespace armcmc::gap_bench
