#pragma once

#include <string>

#include "armcmc/gap/result.hpp"

namespace armcmc::gap {

/// The result as one HTML page that opens offline, for readers who were not there. Text of the result (names of files
/// and columns, notes) is escaped.
/// @throws std::invalid_argument when the arrays of a figure do not fit together, naming the curve.
[[nodiscard]] std::string ReportHtml(const Result& result);

}  // namespace armcmc::gap
