#pragma once

#include <string>
#include <vector>

namespace armcmc::plant_sim {

/// A quantity that somebody recorded, evenly sampled.
struct Series {
  std::string file;  ///< It was read from.
  double interval_s = 0.0;
  std::vector<double> values;  ///< At least two.
};

}  // namespace armcmc::plant_sim
