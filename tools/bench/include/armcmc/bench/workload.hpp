#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "armcmc/data_pack.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::bench {

/// A plant, and how its packs are made.
struct Plant {
  std::string name;  ///< Short, in the names of benchmarks; "NAME:tape" is a built-in plant run as a file describes it.
  std::string model;  ///< Built-in name, name of a plant that came along, or file.
};

/// Settings of the estimator for a plant, with its priors and noise. @throws ConfigError.
[[nodiscard]] EstimatorSettings SettingsOf(const Plant& plant);

/// The plants of the suite: every built-in one, the same by the tape, and those that came along as files.
[[nodiscard]] std::vector<Plant> KnownPlants();

/// Packs of a plant with `samples` samples each, simulated by armcmc-plant (seed 1, so that every run has the same),
/// 1 kHz. Of a plant with modes those in which one mode has every sample: they cost most.
///
/// A plant is simulated once in a process; packs of another length are cut from the same data, which stay in `folder`.
/// @throws std::runtime_error when armcmc-plant fails, or when fewer than three packs are left.
[[nodiscard]] std::vector<DataPack> FullPacks(const Plant& plant, int samples, const std::filesystem::path& folder);

}  // namespace armcmc::bench
