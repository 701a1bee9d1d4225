#pragma once

#include <string>

#include "armcmc/rt/pipeline.hpp"

namespace armcmc::rt {

/// The report of a run as JSON text, "schema": 1. @pre the pipeline has been joined.
///
/// Heap calls that could not be counted (sanitizer build) are null, never 0.
[[nodiscard]] std::string ReportJson(const Pipeline& pipeline);

/// Writes it through a temporary file beside the target, so that no reader sees half a report.
/// @throws std::runtime_error naming the file.
void WriteReport(const Pipeline& pipeline, const std::string& path);

}  // namespace armcmc::rt
