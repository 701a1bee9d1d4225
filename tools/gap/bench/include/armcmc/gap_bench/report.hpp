#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "armcmc/gap_bench/case.hpp"

namespace armcmc::gap_bench {

/// One line about a finished case.
[[nodiscard]] std::string Line(const Outcome& outcome);
/// Rows, gates, calibration and confusion as plain text.
[[nodiscard]] std::string Tables(const std::vector<Outcome>& outcomes);
/// Schema 1: everything that the tables say, and every case with the commands that repeat it.
[[nodiscard]] nlohmann::json ToJson(const std::vector<Outcome>& outcomes, std::uint64_t seed);
/// A page that opens offline.
[[nodiscard]] std::string Html(const std::vector<Outcome>& outcomes, std::uint64_t seed);

}  // namespace armcmc::gap_bench
