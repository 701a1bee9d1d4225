#include "comparison.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

namespace armcmc::ladder {
namespace {

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Whether a group contains so much of the evidence for an effect that leaving it out is not informative: the fit
/// without it gains less than half of what the fit with it gains.
bool HoldsTheEvidence(const Contender& c, const Trial& base, std::size_t group) {
  return 1.0 - c.trial.rest[group] / (base.rest[group] + 1e-300) < 0.5 * c.closed;
}

/// Over the rows of all folds.
double FoldSquares(const View& view, const std::vector<double>& squares) {
  double sum = 0.0;
  for (std::size_t g = 0; g < squares.size(); ++g)
    if (view.groups[g].kind == GroupKind::kFold) sum += squares[g];
  return sum;
}

/// Whether the errors decorrelate within a tenth of the period, as noise shared by neighbouring samples does. A missing
/// part of a law repeats with the motion.
///
/// The mean square of the autocorrelation over lags of 0.1 to 0.6 periods, at most a quarter of the rows, is compared
/// with its value for noise of the same correlation at short lags: 1/n times 1 + 2 sum r^2.
bool ForgottenSoon(const View& view, const Trial& trial) {
  constexpr double kFirst = 0.1, kLast = 0.6, kShare = 0.01, kOfRows = 0.25;
  constexpr int kLags = 40;
  const identify::Series& series = *view.data.series;
  const Eigen::VectorXd error = trial.model->target() - trial.fit.prediction;
  const auto counts = [&](std::size_t n) { return view.data.training[n] != 0 && trial.model->active()[n] != 0; };
  std::vector<std::size_t> run(series.num_rows(), 0);
  for (std::size_t n = 1; n < run.size(); ++n)
    run[n] = run[n - 1] + (std::binary_search(series.runs.begin(), series.runs.end(), n) ? 1 : 0);
  double all = 0.0, count = 0.0;
  for (std::size_t n = 0; n < run.size(); ++n)
    if (counts(n)) {
      all += error[static_cast<Eigen::Index>(n)] * error[static_cast<Eigen::Index>(n)];
      count += 1.0;
    }
  const auto correlation = [&](std::size_t lag) {
    double sum = 0.0, pairs = 0.0;
    for (std::size_t n = 0; n + lag < run.size(); ++n)
      if (counts(n) && counts(n + lag) && run[n] == run[n + lag]) {
        sum += error[static_cast<Eigen::Index>(n)] * error[static_cast<Eigen::Index>(n + lag)];
        pairs += 1.0;
      }
    return pairs > 0.0 ? sum / pairs / (all / count + 1e-300) : 0.0;
  };
  const double per_period = view.period / series.dt;
  const double farthest = std::min(kLast * per_period, kOfRows * count);
  if (!(kFirst * per_period > 2.0) || !(farthest > 2.0 * kFirst * per_period)) return false;
  const auto first = static_cast<std::size_t>(kFirst * per_period);
  double near = 1.0;
  for (std::size_t lag = 1; lag < first; ++lag) near += 2.0 * std::pow(correlation(lag), 2);
  double far = 0.0;
  for (int k = 0; k < kLags; ++k) {
    const double nearest = kFirst * per_period, lag = nearest + (farthest - nearest) * k / (kLags - 1);
    far += std::pow(correlation(static_cast<std::size_t>(lag)), 2) / kLags;
  }
  return far < kShare + 2.0 * near / count;
}

}  // namespace

Comparison Compare(const View& view, const Contender& c, const Trial& base_trial, bool with_flexible) {
  const std::vector<double>& mine = with_flexible ? c.trial.with_flexible : c.trial.alone;
  const std::vector<double>& base = with_flexible ? base_trial.with_flexible : base_trial.alone;
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

std::string LeavesLessText(double times) {
  char text[64];
  std::snprintf(text, sizeof(text), "leaves %.1f times less squared error on data left out", times);
  return text;
}

bool BetterEverywhere(const Contender& a, const Contender& b) {
  return a.alone.folds < b.alone.folds && a.alone.blocks < b.alone.blocks && a.alone.regions < b.alone.regions;
}

bool ExtrapolatesBetter(const Contender& a, const Contender& b) {
  return a.alone.blocks < b.alone.blocks && a.alone.regions < b.alone.regions;
}

double FlexibleGain(const View& view, const Trial& trial) {
  return 1.0 - FoldSquares(view, trial.with_flexible) / (FoldSquares(view, trial.alone) + 1e-300);
}

double NoiseIn(const View& view, const Trial& trial, double floor) {
  const double square = trial.fit.error_sd * trial.fit.error_sd;
  return std::min(floor * floor, square * std::clamp(1.0 - FlexibleGain(view, trial), 0.0, 1.0));
}

double UnexplainedShare(const View& view, const Trial& trial) {
  const Eigen::VectorXd target = trial.model->target()(view.active_rows);
  const double varies = (target.array() - target.mean()).matrix().squaredNorm();
  return (target - trial.fit.prediction(view.active_rows)).squaredNorm() / (varies + 1e-300);
}

bool WorseThanConstant(const View& view, const Trial& trial) { return UnexplainedShare(view, trial) > 1.0; }

bool LeavesMore(const View& view, const Trial& trial, double floor) {
  constexpr double kMore = 0.5 * kLeastGain, kRougher = 1.2, kFarRougher = 3.0;
  if (FlexibleGain(view, trial) > kMore) return true;
  if (!(floor > 0.0) || trial.fit.error_sd < kRougher * floor) return false;
  return trial.fit.error_sd > kFarRougher * floor || !ForgottenSoon(view, trial);
}

}  // namespace armcmc::ladder
