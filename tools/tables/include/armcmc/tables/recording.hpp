#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "armcmc/data_pack.hpp"

namespace armcmc::tables {

/// A recording with its truth: sample i at t = i T, the first row is sample 0.
struct Recording {
  std::string name;
  PlantNumber plant = PlantNumber::kNone;
  double dt = 1e-3;
  std::array<std::vector<double>, 4> u;  ///< x, v; or u_c, u_d, p, pdot.
  std::vector<double> y;                 ///< Measured force or angle.
  std::vector<double> target;            ///< True force; or true valve flow.
  /// True parameters at each sample: K, B, p; or g, theta2 of the valve that acts.
  std::array<std::vector<double>, 3> truth;
  [[nodiscard]] std::size_t size() const { return y.size(); }
};

/// Reads a recording of the plant, or the authors' (their truth is constant, or written as theta1).
/// @throws support::InputError naming the file and what was expected.
[[nodiscard]] Recording ReadRecording(const std::filesystem::path& path, PlantNumber plant, double p_atm);

/// Samples (k-1) N + 1 .. k N as pack k. @pre They exist.
void FillPack(const Recording& recording, int k, int samples, DataPack* pack);

/// Runs armcmc-plant, a process of its own, on a scenario. @return the CSV that it wrote.
/// @throws std::runtime_error with what the plant said.
std::filesystem::path Simulate(const std::string& scenario, std::uint64_t seed, const std::filesystem::path& folder);

}  // namespace armcmc::tables
