#pragma once

#include <vector>

namespace armcmc::support {

/// Rate of a measured series, and how it was made.
struct Rate {
  std::vector<double> value;  ///< [row] per second.
  double bandwidth_hz = 0.0;  ///< Of the low pass without delay; 0: none, central differences.
};

/// Time derivative of x, row by row.
///
/// Where the rows are evenly spaced, apart from gaps, each stretch between gaps is filtered without delay with the
/// bandwidth that the noise of the longest one suggests (SuitableBandwidth), and differenced (Derivative). Where they
/// are not, or a stretch has fewer than 10 rows, it is the central difference over the neighbours, one-sided at the
/// ends.
/// @param t  s, increasing. @pre At least 2 rows.
[[nodiscard]] Rate RateOf(const std::vector<double>& t, const std::vector<double>& x);

}  // namespace armcmc::support
