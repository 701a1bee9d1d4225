#pragma once

#include <string>

#include "plant_options.hpp"

namespace armcmc::plant_sim {

/// Plays a recording file onto the bus (PlayRuns), in packs of the length that armcmc-replay cuts it into.
/// @param data_dir  Where its CSV is if not beside it; may be empty.
/// @param speed     > 0.
/// @return the exit code. @throws support::ConfigError, support::InputError, std::runtime_error.
int RunRecording(const std::string& path, const std::string& data_dir, double speed, const PlantOptions& options);

}  // namespace armcmc::plant_sim
