#pragma once

#include "armcmc/plant_sim/scenario.hpp"
#include "plant_options.hpp"

namespace armcmc::plant_sim {

/// Publishes the scenario in real time, scores the estimates that come back, prints the table and writes the
/// files that were asked for. Ends after the duration, or early and cleanly on SIGINT or SIGTERM.
/// @return the exit code. @throws std::runtime_error when the bus or a file cannot be opened.
int RunLive(const Scenario& scenario, const PlantOptions& options);

}  // namespace armcmc::plant_sim
