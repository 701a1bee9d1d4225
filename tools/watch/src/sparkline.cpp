#include "armcmc/watch/sparkline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace armcmc::watch {
namespace {

constexpr std::array<const char*, 8> kBlocks = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
constexpr std::array<const char*, 8> kMarks = {".", ":", "-", "=", "+", "*", "#", "@"};
constexpr std::array<const char*, 8> kEighths = {"", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};

const char* Glyph(double share, Glyphs glyphs) {
  const auto level = static_cast<std::size_t>(std::clamp(std::lround(share * 7.0), 0L, 7L));
  return glyphs == Glyphs::kUnicode ? kBlocks[level] : kMarks[level];
}

}  // namespace

std::string Sparkline(std::span<const double> values, double lo, double hi, Glyphs glyphs) {
  std::string text;
  for (const double value : values) {
    text += std::isfinite(value) ? Glyph(hi > lo ? (value - lo) / (hi - lo) : 0.5, glyphs) : " ";
  }
  return text;
}

std::string Sparkline(std::span<const double> values, Glyphs glyphs) {
  double lo = std::numeric_limits<double>::infinity();
  double hi = -lo;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    lo = std::min(lo, value);
    hi = std::max(hi, value);
  }
  return Sparkline(values, lo, hi, glyphs);
}

std::string Bar(double share, int columns, Glyphs glyphs) {
  const double filled = (std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 0.0) * columns;
  int whole = static_cast<int>(filled);
  std::string text;
  for (int i = 0; i < whole; ++i) text += glyphs == Glyphs::kUnicode ? "█" : "#";
  if (glyphs == Glyphs::kUnicode && whole < columns) {
    const std::string part = kEighths[static_cast<std::size_t>((filled - whole) * 8.0)];
    text += part;
    if (!part.empty()) ++whole;
  } else if (whole == 0 && filled > 0.0) {
    text += ".";  // something, where there are no eighths
    ++whole;
  }
  return text + std::string(static_cast<std::size_t>(columns - whole), ' ');
}

std::string DensityLine(std::span<const double> bins, int columns, Glyphs glyphs) {
  const auto n = static_cast<std::size_t>(std::max(columns, 1));
  std::vector<double> means(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t from = i * bins.size() / n;
    const std::size_t to = std::max(from + 1, (i + 1) * bins.size() / n);
    for (std::size_t k = from; k < to && k < bins.size(); ++k) means[i] += bins[k] / static_cast<double>(to - from);
  }
  const double peak = *std::max_element(means.begin(), means.end());
  return Sparkline(means, 0.0, peak, glyphs);
}

}  // namespace armcmc::watch
