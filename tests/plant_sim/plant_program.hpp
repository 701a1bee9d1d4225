#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::plant_sim {

/// Runs armcmc-plant in a folder, to its end.
[[nodiscard]] inline test::Outcome RunPlant(const std::vector<std::string>& arguments, const test::ScratchDir& folder) {
  return test::RunProgram(test::Program("armcmc-plant"), arguments, std::chrono::minutes(1), folder.path());
}

}  // namespace armcmc::plant_sim
