#pragma once

#include <cstddef>
#include <vector>

namespace armcmc::plots {

/// Which samples of a long curve to draw so that a screen shows the same: at most about `max_points`.
///
/// The samples are cut into runs of equal length; of each run stay the first, the lowest and the highest of every row,
/// and one sample that is not finite, so that gaps stay gaps. The first and the last sample always stay.
///
/// @param rows        Values that share their x, all of one length; an empty row is left out.
/// @param max_points  >= 2.
/// @return Ascending indices.
/// @throws std::invalid_argument for rows of different lengths or max_points < 2.
[[nodiscard]] std::vector<std::size_t> Decimate(const std::vector<const std::vector<double>*>& rows,
                                                std::size_t max_points);

}  // namespace armcmc::plots
