#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "armcmc/gap_bench/case.hpp"

namespace armcmc::gap_bench {

/// The stratum that real recordings are needed for.
inline constexpr const char* kRecorded = "recorded";
/// Its group whose noise is real, too.
inline constexpr const char* kRealNoise = "real motion and noise";

/// Names of all strata.
[[nodiscard]] const std::vector<std::string>& StratumNames();

/// Whether the plant of a stratum is not the catalogue: its law differs from the formula, it holds what nobody listed,
/// or its effects have formulas of their own.
[[nodiscard]] bool Imperfect(const std::string& stratum);

/// The cases of a stratum. A case depends on the seed, its stratum, its cell and its number in the cell alone, so that
/// larger runs repeat the cases of smaller ones.
///
/// Scenarios that no file of the plant describes are written to `folder`/scenarios.
/// @param recordings  Folder of the real recordings whose motion and noise the stratum "recorded" takes.
/// @throws std::invalid_argument for a stratum that does not exist; support::InputError for a recording that cannot be
/// read.
[[nodiscard]] std::vector<Case> CasesOf(const std::string& stratum, int logs_per_cell, std::uint64_t seed,
                                        const std::filesystem::path& folder,
                                        const std::filesystem::path& recordings = {});

}  // namespace armcmc::gap_bench
