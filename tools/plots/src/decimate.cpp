#include "armcmc/plots/decimate.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace armcmc::plots {
namespace {

/// Adds the samples of [begin, end) that a screen would show.
void KeepOfRun(const std::vector<double>& row, std::size_t begin, std::size_t end, std::vector<std::size_t>* kept) {
  std::size_t lowest = end, highest = end, gap = end;
  for (std::size_t i = begin; i < end; ++i) {
    if (!std::isfinite(row[i])) {
      gap = i;
      continue;
    }
    if (lowest == end || row[i] < row[lowest]) lowest = i;
    if (highest == end || row[i] > row[highest]) highest = i;
  }
  for (const std::size_t i : {lowest, highest, gap})
    if (i != end) kept->push_back(i);
}

}  // namespace

std::vector<std::size_t> Decimate(const std::vector<const std::vector<double>*>& rows, std::size_t max_points) {
  if (max_points < 2) throw std::invalid_argument("Decimate: max_points must be at least 2");
  std::vector<const std::vector<double>*> used;
  for (const auto* row : rows)
    if (!row->empty()) used.push_back(row);
  if (used.empty()) return {};
  const std::size_t n = used.front()->size();
  for (const auto* row : used)
    if (row->size() != n) throw std::invalid_argument("Decimate: rows of different lengths");

  std::vector<std::size_t> kept;
  if (n <= max_points) {
    kept.resize(n);
    std::iota(kept.begin(), kept.end(), std::size_t{0});
    return kept;
  }
  // Each run leaves its first sample and two of every row; a gap is rare.
  const std::size_t runs = std::max<std::size_t>(1, max_points / (1 + 2 * used.size()));
  for (std::size_t run = 0; run < runs; ++run) {
    const std::size_t begin = run * n / runs, end = (run + 1) * n / runs;
    kept.push_back(begin);
    for (const auto* row : used) KeepOfRun(*row, begin, end, &kept);
  }
  kept.push_back(n - 1);
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  return kept;
}

}  // namespace armcmc::plots
