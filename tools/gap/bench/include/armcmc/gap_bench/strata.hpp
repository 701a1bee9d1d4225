#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "armcmc/gap_bench/case.hpp"

namespace armcmc::gap_bench {

/// Names of all strata.
[[nodiscard]] const std::vector<std::string>& StratumNames();

/// The cases of a stratum. A case depends on the seed, its stratum, its cell and its number in the cell alone, so that
/// larger runs repeat the cases of smaller ones.
///
/// Scenarios that no file of the plant describes are written to `folder`/scenarios.
/// @throws std::invalid_argument for a stratum that does not exist.
[[nodiscard]] std::vector<Case> CasesOf(const std::string& stratum, int logs_per_cell, std::uint64_t seed,
                                        const std::filesystem::path& folder);

}  // namespace armcmc::gap_bench
