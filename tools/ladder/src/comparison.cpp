#include "comparison.hpp"

#include <algorithm>
#include <map>

namespace armcmc::ladder {
namespace {

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Whether a group holds so much of what shows an effect that its absence says nothing: without it the fit gains less
/// than half of what it gains with it.
bool HoldsTheEvidence(const Contender& c, const Trial& base, std::size_t group) {
  return 1.0 - c.trial.rest[group] / (base.rest[group] + 1e-300) < 0.5 * c.closed;
}

/// Of the rows of all folds together.
double FoldSquares(const View& view, const std::vector<double>& squares) {
  double sum = 0.0;
  for (std::size_t g = 0; g < squares.size(); ++g)
    if (view.groups[g].kind == GroupKind::kFold) sum += squares[g];
  return sum;
}

}  // namespace

Comparison Compare(const View& view, const Contender& c, const Trial& base_trial, bool beside) {
  const std::vector<double>& mine = beside ? c.trial.beside : c.trial.alone;
  const std::vector<double>& base = beside ? base_trial.beside : base_trial.alone;
  std::map<GroupKind, double> sum, sum_base;
  std::map<GroupKind, std::vector<double>> ratios;
  for (std::size_t g = 0; g < mine.size(); ++g) {
    const GroupKind kind = view.groups[g].kind;
    if (kind != GroupKind::kFold && HoldsTheEvidence(c, base_trial, g)) continue;
    sum[kind] += mine[g];
    sum_base[kind] += base[g];
    ratios[kind].push_back(mine[g] / (base[g] + 1e-300));
  }
  const auto ratio = [&](GroupKind kind) {
    if (ratios[kind].empty()) return 1.0;
    const double of_sums = sum[kind] / (sum_base[kind] + 1e-300);
    return kind == GroupKind::kFold ? of_sums : std::min(of_sums, Median(ratios[kind]));
  };
  return {ratio(GroupKind::kFold), ratio(GroupKind::kBlock), ratio(GroupKind::kRegion)};
}

double FlexibleGain(const View& view, const Trial& trial) {
  return 1.0 - FoldSquares(view, trial.beside) / (FoldSquares(view, trial.alone) + 1e-300);
}

bool LeavesMore(const View& view, const Trial& trial, double floor) {
  constexpr double kMore = 0.5 * kLeastGain, kRougher = 1.2;
  return FlexibleGain(view, trial) > kMore || (floor > 0.0 && trial.fit.error_sd > kRougher * floor);
}

}  // namespace armcmc::ladder
