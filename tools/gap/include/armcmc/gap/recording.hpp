#pragma once

#include <string>
#include <vector>

#include "armcmc/gap/types.hpp"

namespace armcmc::gap {

/// Samples of one experiment by column, evenly spaced in time.
struct Recording {
  std::string source;  ///< File that it was read from, for messages.
  double dt = 0.0;     ///< s
  Vector t;            ///< s
  std::vector<std::string> names;
  std::vector<Vector> columns;     ///< [name][row]
  std::vector<std::string> notes;  ///< Columns derived, rows skipped, gaps.

  [[nodiscard]] Eigen::Index rows() const { return t.size(); }
  /// Column of that name.
  /// @throws std::invalid_argument listing the available columns.
  [[nodiscard]] const Vector& Column(const std::string& name) const;
  /// Rows [first, first + count).
  [[nodiscard]] Recording Slice(Eigen::Index first, Eigen::Index count) const;
};

/// Reads the columns that an equation needs and puts them on an even grid.
///
/// A missing velocity column is derived from its position. Jittered sampling is resampled; a recording with more than
/// one hole is an error.
/// @throws support::InputError naming file, line and what was expected.
[[nodiscard]] Recording ReadRecording(const std::string& path, const std::vector<std::string>& columns, bool skip_bad);

}  // namespace armcmc::gap
