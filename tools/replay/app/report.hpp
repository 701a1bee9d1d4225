#pragma once

#include <filesystem>
#include <string>

#include "armcmc/estimator.hpp"
#include "armcmc/replay/pack_source.hpp"
#include "armcmc/replay/replay.hpp"

namespace armcmc::replay {

/// The summary that the program prints: packs, final estimates, speed, notes.
[[nodiscard]] std::string SummaryText(const Estimator& estimator, const PackSource& source,
                                      const ReplaySummary& summary);

/// The same as JSON, schema 1. @throws std::runtime_error when the file cannot be written.
void WriteReport(const std::filesystem::path& path, const Estimator& estimator, const PackSource& source,
                 const ReplaySummary& summary);

}  // namespace armcmc::replay
