#pragma once

#include <string>

#include "armcmc/compare/trace.hpp"

namespace armcmc::compare {

/// Two runs over the same recording beside each other, as a page that opens offline: what was set differently, the last
/// estimates and their differences, traces with 95 % bands, residuals, evidence, decisions, draws and times.
/// @param recording  Name for the reader.
[[nodiscard]] std::string ReportHtml(const RunTrace& a, const RunTrace& b, const std::string& recording);

/// The table of differences for a terminal.
[[nodiscard]] std::string SummaryText(const RunTrace& a, const RunTrace& b);

}  // namespace armcmc::compare
