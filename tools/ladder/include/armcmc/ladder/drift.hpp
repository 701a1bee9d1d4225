#pragma once

#include <vector>

#include "armcmc/gap/run.hpp"
#include "armcmc/ladder/dataset.hpp"
#include "armcmc/ladder/trial.hpp"
#include "armcmc/ladder/tuned.hpp"

namespace armcmc::ladder {

/// Constancy of the parameters: the law is refitted to each of about ten segments, with the priors of the plant file.
///
/// The fit to a segment starts from the fit to all rows. Its band is 1.96 posterior standard deviations, with the
/// number of rows reduced by the autocorrelation of the errors. If a parameter is constant, the weighted sum of squares
/// of its values about their weighted mean, each divided by its variance, has a chi-square distribution. A law with
/// memory also sees the rows before a segment, which are not fitted. Segments that do not determine a parameter are
/// skipped. (The estimator is not suitable for this test: it learns from a tenth of a second at a time and restarts
/// from its prior when real data contradict the model, so its own variation hides a slow drift.)
/// @param data  All rows are used, including held-out ones.
[[nodiscard]] std::vector<gap::ParameterDrift> DriftOver(const Dataset& data, const TunedPlant& before,
                                                         const Trial& base, const TunedPlant* after,
                                                         const Trial& final_trial);

/// Mean, band, movement and verdict of a parameter from its values on the segments.
/// @param value, sd  [segment] Value and standard deviation, in the coordinates in which the parameter is sampled.
void JudgeConstancy(const std::vector<double>& value, const std::vector<double>& sd, gap::Constancy* out);

}  // namespace armcmc::ladder
