#pragma once

#include <Eigen/Core>
#include <vector>

#include "armcmc/identify/trajectory_model.hpp"
#include "armcmc/ladder/candidates.hpp"
#include "armcmc/ladder/dataset.hpp"

namespace armcmc::ladder {

/// Adds starts at the frequency where the error of the first one has most power, with the amplitudes that it has there:
/// a fit finds a frequency only from next to it, and without an amplitude nothing but its prior would tell it where to
/// go.
/// @param starts  Of the model's parameters; one at least.
void AddFrequencies(const identify::TrajectoryModel& model, const Dataset& data,
                    const std::vector<Frequency>& frequencies, std::vector<Eigen::VectorXd>* starts);

}  // namespace armcmc::ladder
