#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "case_builder.hpp"

namespace armcmc::gap_bench {

/// Contact along motions that were really recorded, under noise that a real force sensor made: nothing hidden, and each
/// effect with R = 1. Every recording is judged as a whole and by its halves.
/// @param recordings  Folder of the files named in motions.toml.
/// @throws support::InputError for one that is missing or cannot be read.
void AddRecorded(const std::filesystem::path& recordings, const std::vector<std::string>& effects,
                 CaseBuilder* builder);

}  // namespace armcmc::gap_bench
