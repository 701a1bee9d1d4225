#pragma once

#include <filesystem>
#include <string>

#include "armcmc/stress/options.hpp"

namespace armcmc::stress {

/// The scenario of the plant: always in contact, never a change, so that whatever the estimate does is ours.
[[nodiscard]] std::string ScenarioText(const StressOptions& options);

/// The configuration of the estimator, with its plan of injected faults; "" is none.
[[nodiscard]] std::string EstimatorConfigText(const StressOptions& options, const std::string& plan);

/// @throws std::runtime_error when it cannot be written.
void WriteText(const std::filesystem::path& path, const std::string& text);

}  // namespace armcmc::stress
