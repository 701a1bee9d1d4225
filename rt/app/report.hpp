#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "armcmc/rt/pipeline.hpp"

namespace armcmc::rt {

/// What became of the file of --resume.
struct SnapshotCounts {
  std::string path;
  std::int64_t resumed_from = 0;  ///< Pack; 0: the run started afresh.
  std::int64_t written = 0, failed = 0;
};

/// The report of a run on one of its plants as JSON text, "schema": 1. @pre the pipeline has been joined.
///
/// @param gap_window  File with the data around a suspected gap; empty: none.
/// Heap calls that could not be counted (sanitizer build) are null, never 0.
[[nodiscard]] std::string ReportJson(const Pipeline& pipeline, const Lane& lane, const std::string& gap_window = "",
                                     const std::optional<SnapshotCounts>& snapshot = std::nullopt);

/// Writes it through a temporary file in the same folder, so that no reader sees half a report.
/// @throws std::runtime_error naming the file.
void WriteReport(const Pipeline& pipeline, const Lane& lane, const std::string& path,
                 const std::string& gap_window = "", const std::optional<SnapshotCounts>& snapshot = std::nullopt);

}  // namespace armcmc::rt
