#pragma once

#include <string>

#include "armcmc/gap/result.hpp"

namespace armcmc::gap {

/// The result as one self-contained HTML page. Text of the result (names of files
/// and columns, notes) is escaped.
/// @throws std::invalid_argument, naming the curve, if the arrays of a figure differ in length.
[[nodiscard]] std::string ReportHtml(const Result& result);

}  // namespace armcmc::gap
