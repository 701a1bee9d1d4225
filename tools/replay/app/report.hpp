#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "armcmc/estimator.hpp"
#include "armcmc/replay/pack_source.hpp"
#include "armcmc/replay/replay.hpp"
#include "armcmc/replay/verify.hpp"

namespace armcmc::replay {

/// The summary that the program prints: packs, final estimates, speed, notes.
[[nodiscard]] std::string SummaryText(const Estimator& estimator, const PackSource& source,
                                      const ReplaySummary& summary);

/// What a comparison with the live run found.
[[nodiscard]] std::string VerificationText(const Verification& verification, const PackSource& source);

/// The summary, and the verification if there was one, as JSON, schema 1.
/// @throws std::runtime_error when the file cannot be written.
void WriteReport(const std::filesystem::path& path, const Estimator& estimator, const PackSource& source,
                 const ReplaySummary& summary, const std::optional<Verification>& verification);

}  // namespace armcmc::replay
