#pragma once

#include <string>
#include <vector>

namespace armcmc::gap {

/// One curve of a figure. `low` and `high` may be empty.
struct Curve {
  std::string label;
  std::vector<double> x, y, low, high;
};

}  // namespace armcmc::gap
