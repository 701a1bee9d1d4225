#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "plant_options.hpp"

namespace armcmc::plant_sim {

/// What a command line says about the simulation of a described plant.
struct DescribedRequest {
  std::string scenario;               ///< Path; empty: UsualScenario, which is said on stderr.
  std::optional<double> duration_s;   ///< Instead of the scenario's.
  std::optional<std::uint64_t> seed;  ///< Instead of the scenario's.
  double speed = 1.0;                 ///< Of a live run.
  bool live = true;                   ///< Publish in real time; else write the CSV, and the log that was asked for.
};

/// The plant file that `--model` means: a path, or the name of a plant that came with the product. Nothing where it is
/// a model file of a built-in plant.
/// @throws support::ConfigError where there is no such file.
[[nodiscard]] std::optional<std::filesystem::path> PlantFileOf(const std::string& model);

/// Simulates a described plant and publishes or writes its signals.
/// @return the exit code. @throws support::ConfigError, support::InputError, std::runtime_error.
int RunDescribed(const std::filesystem::path& plant_file, const DescribedRequest& request, const PlantOptions& options);

}  // namespace armcmc::plant_sim
