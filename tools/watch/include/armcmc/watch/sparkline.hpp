#pragma once

#include <span>
#include <string>

namespace armcmc::watch {

/// Which characters a terminal has.
enum class Glyphs { kUnicode, kAscii };

/// Eight block characters, or eight of ASCII that grow darker. One column for each value, from the least of them to the
/// largest; a value that is not finite is a space; equal values are a line at half height.
[[nodiscard]] std::string Sparkline(std::span<const double> values, Glyphs glyphs);

/// The same from `lo` (empty) to `hi` (full).
[[nodiscard]] std::string Sparkline(std::span<const double> values, double lo, double hi, Glyphs glyphs);

/// A bar of `columns` columns, `share` of it full: in eighths of a column where there is Unicode.
/// @param share  Below 0 is 0, above 1 is 1.
[[nodiscard]] std::string Bar(double share, int columns, Glyphs glyphs);

/// A histogram in fewer columns: each is the mean of the bins that it covers.
/// @param columns  [1, bins.size()]
[[nodiscard]] std::string DensityLine(std::span<const double> bins, int columns, Glyphs glyphs);

}  // namespace armcmc::watch
