#pragma once

#include "armcmc/plant_sim/scenario.hpp"
#include "plant_options.hpp"

namespace armcmc::plant_sim {

/// Writes the scenario's data to files as fast as possible, without a bus. The log is stamped as if the run had
/// started at time 0 of both clocks. @return the exit code. @throws std::runtime_error when a file cannot be written.
int RunOffline(const Scenario& scenario, const PlantOptions& options);

}  // namespace armcmc::plant_sim
