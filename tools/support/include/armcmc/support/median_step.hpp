#pragma once

#include <vector>

namespace armcmc::support {

/// Median interval of times that increase, s. @pre At least 2.
[[nodiscard]] double MedianStep(const std::vector<double>& t);

}  // namespace armcmc::support
