#pragma once

#include <vector>

#include "armcmc/gap/run.hpp"
#include "armcmc/ladder/dataset.hpp"
#include "armcmc/ladder/trial.hpp"
#include "armcmc/ladder/tuned.hpp"

namespace armcmc::ladder {

/// Parameters over a recording: the law fitted anew to each of about ten stretches, with the priors of the plant's
/// file.
///
/// The fit to a stretch is that to all rows, moved; its band is 1.96 standard deviations of the posterior with errors
/// that go together counted once. A parameter that stays has values that differ as their bands say: the sum of squares
/// about their weighted mean, each over its variance, has the chi-square law. A plant that remembers also sees the rows
/// before a stretch, which do not count. Stretches that say nothing of a parameter are left out. (The estimator itself
/// would not tell: it learns from a tenth of a second at a time, and where real data contradict the model, it begins
/// anew from its prior, so that a slow drift is hidden behind its own movement.)
/// @param data  All rows count, also those that are kept apart.
[[nodiscard]] std::vector<gap::ParameterDrift> DriftOver(const Dataset& data, const TunedPlant& before,
                                                         const Trial& base, const TunedPlant* after,
                                                         const Trial& final_trial);

/// Fills what is told of the stretches from their values.
/// @param value, sd  [stretch] In the coordinates in which it is sampled.
void JudgeSteadiness(const std::vector<double>& value, const std::vector<double>& sd, gap::Steadiness* out);

}  // namespace armcmc::ladder
