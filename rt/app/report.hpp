#pragma once

#include <string>

#include "armcmc/rt/pipeline.hpp"

namespace armcmc::rt {

/// The report of a run as JSON text, "schema": 1. @pre the pipeline has been joined.
///
/// @param gap_window  File with the data around a suspected gap; empty: none.
/// Heap calls that could not be counted (sanitizer build) are null, never 0.
[[nodiscard]] std::string ReportJson(const Pipeline& pipeline, const std::string& gap_window = "");

/// Writes it through a temporary file beside the target, so that no reader sees half a report.
/// @throws std::runtime_error naming the file.
void WriteReport(const Pipeline& pipeline, const std::string& path, const std::string& gap_window = "");

}  // namespace armcmc::rt
