#pragma once

#include <string>
#include <utility>
#include <vector>

namespace armcmc::gap_bench {

/// A quantity in a real recording: a sum of columns.
struct RecordedSource {
  std::string name;
  std::string file;
  std::string time;
  double second = 1.0;                                  ///< Of the time column, s.
  std::vector<std::pair<std::string, double>> columns;  ///< With their factors.
  double until_s = 1e9;                                 ///< The part from the beginning that is taken.
};

struct RecordedSources {
  std::vector<RecordedSource> motions;
  RecordedSource noise;  ///< Of a force sensor.
};

/// What motions.toml says. @throws support::ConfigError with the place of what is wrong.
[[nodiscard]] RecordedSources ReadRecordedSources();

}  // namespace armcmc::gap_bench
