#pragma once

#include <Eigen/Core>
#include <vector>

#include "armcmc/identify/trajectory_model.hpp"
#include "armcmc/ladder/candidates.hpp"
#include "armcmc/ladder/dataset.hpp"

namespace armcmc::ladder {

/// Adds starts at the frequency at which the residual of the first start has most power, with the amplitudes found
/// there. A fit converges to a frequency only from nearby, and with zero amplitude only the prior would act on the
/// frequency.
/// @param starts  Parameter vectors of the model; at least one.
void AddFrequencies(const identify::TrajectoryModel& model, const Dataset& data,
                    const std::vector<Frequency>& frequencies, std::vector<Eigen::VectorXd>* starts);

}  // namespace armcmc::ladder
