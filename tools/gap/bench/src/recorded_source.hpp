#pragma once

#include <string>
#include <utility>
#include <vector>

namespace armcmc::gap_bench {

/// A quantity in a real recording: a sum of columns.
struct RecordedSource {
  const char* name;
  const char* file;
  const char* time;
  double second;                                        ///< Of the time column, s.
  std::vector<std::pair<std::string, double>> columns;  ///< With their factors.
  double until_s;                                       ///< The part from the beginning that is taken.
};

}  // namespace armcmc::gap_bench
