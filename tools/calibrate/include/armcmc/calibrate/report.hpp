#pragma once

#include <string>

#include "armcmc/calibrate/calibrate.hpp"

namespace armcmc::calibrate {

/// Where the numbers of a calibration come from, as a page that opens offline.
/// @param recording, config  Names for the reader.
/// @param unit               Of the regression target.
[[nodiscard]] std::string ReportHtml(const Calibration& calibration, const std::string& recording,
                                     const std::string& config, const std::string& unit);

/// The same in a few lines for a terminal.
[[nodiscard]] std::string SummaryText(const Calibration& calibration, const std::string& unit);

}  // namespace armcmc::calibrate
