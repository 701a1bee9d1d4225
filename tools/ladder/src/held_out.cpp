#include "held_out.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "armcmc/gap/blocks.hpp"
#include "armcmc/ladder/features.hpp"

namespace armcmc::ladder {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Ljung-Box statistic, divided by its degrees of freedom.
double Whiteness(const VectorXd& e) {
  constexpr Index kLags = 25;
  const VectorXd x = e.array() - e.mean();
  const double all = x.squaredNorm();
  if (x.size() < 4 * kLags || !(all > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  const auto n = static_cast<double>(x.size());
  double sum = 0.0;
  for (Index lag = 1; lag <= kLags; ++lag) {
    const double r = x.head(x.size() - lag).dot(x.tail(x.size() - lag)) / all;
    sum += r * r / (n - static_cast<double>(lag));
  }
  return n * (n + 2.0) * sum / static_cast<double>(kLags);
}

/// Thins a curve to limit the size of the page; NaN at the beginning of a run breaks the line.
gap::Curve Over(const Dataset& data, const VectorXd& value, std::size_t most) {
  gap::Curve curve;
  const std::size_t every = std::max<std::size_t>(1, data.series->num_rows() / most);
  std::size_t run = 0;
  for (std::size_t n = 0; n < data.series->num_rows(); n += every) {
    const std::size_t before = run;
    while (run < data.series->runs.size() && data.series->runs[run] <= n) ++run;
    curve.x.push_back(data.series->t.front() + data.series->dt * static_cast<double>(n));
    curve.y.push_back(run != before && n > 0 ? std::numeric_limits<double>::quiet_NaN() : value[static_cast<Index>(n)]);
  }
  return curve;
}

/// Mean error in twenty bins of a feature, with bands of two standard errors over segments.
gap::Curve Binned(const VectorXd& error, const VectorXd& feature, std::vector<Index> rows) {
  constexpr std::size_t kBins = 20;
  gap::Curve curve;
  std::sort(rows.begin(), rows.end(), [&](Index a, Index b) { return feature[a] < feature[b]; });
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    const std::size_t from = bin * rows.size() / kBins, to = (bin + 1) * rows.size() / kBins;
    if (to < from + 5) continue;
    double x = 0.0, mean = 0.0, square = 0.0;
    for (std::size_t k = from; k < to; ++k) {
      x += feature[rows[k]] / static_cast<double>(to - from);
      mean += error[rows[k]] / static_cast<double>(to - from);
    }
    for (std::size_t k = from; k < to; ++k) square += std::pow(error[rows[k]] - mean, 2);
    const double half = 1.96 * std::sqrt(square) / static_cast<double>(to - from);
    if (!curve.x.empty() && x <= curve.x.back()) continue;
    curve.x.push_back(x);
    curve.y.push_back(mean);
    curve.low.push_back(mean - half);
    curve.high.push_back(mean + half);
  }
  return curve;
}

}  // namespace

WholeRun RunWhole(const Dataset& data, const Trial& trial) {
  WholeRun run;
  const auto plant = std::make_shared<const Plant>(trial.model->plant().description());
  run.model = std::make_shared<const identify::TrajectoryModel>(plant, data.series);
  if (!run.model->PredictOne(trial.fit.theta, &run.prediction)) {
    run.prediction.resize(0);
    return run;
  }
  run.error = run.model->target() - run.prediction;
  return run;
}

gap::Fit FitOn(const WholeRun& run, const std::vector<Index>& rows, double sd) {
  gap::Fit fit;
  if (rows.empty() || run.error.size() == 0) {
    fit.rmse = fit.mae = fit.worst_1_percent = fit.coverage95 = std::numeric_limits<double>::quiet_NaN();
    return fit;
  }
  const VectorXd error = run.error(rows);
  const auto size = static_cast<double>(rows.size());
  std::vector<double> magnitude(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) magnitude[k] = std::fabs(error[static_cast<Index>(k)]);
  fit.coverage95 =
      static_cast<double>(std::count_if(magnitude.begin(), magnitude.end(), [&](double m) { return m < 1.96 * sd; })) /
      size;
  fit.rmse = std::sqrt(error.squaredNorm() / size);
  fit.mae = std::accumulate(magnitude.begin(), magnitude.end(), 0.0) / size;
  const auto at = magnitude.begin() + static_cast<std::ptrdiff_t>(0.99 * (size - 1.0));
  std::nth_element(magnitude.begin(), at, magnitude.end());
  fit.worst_1_percent = *at;
  fit.whiteness = Whiteness(error);
  return fit;
}

std::vector<Index> HeldOutRows(const Dataset& data, const WholeRun& run) {
  std::vector<Index> rows;
  for (std::size_t n = 0; n < data.held_out.size(); ++n)
    if (data.held_out[n] != 0 && run.model->active()[n] != 0) rows.push_back(static_cast<Index>(n));
  return rows;
}

std::vector<gap::SegmentFit> StretchesOf(const Dataset& data, const std::vector<Index>& rows, const WholeRun& before,
                                         const WholeRun& after) {
  constexpr std::size_t kMost = 20;
  std::vector<gap::SegmentFit> stretches;
  if (before.error.size() == 0 || after.error.size() == 0) return stretches;
  const auto kept_apart = [&data](Index n) { return data.held_out[static_cast<std::size_t>(n)] != 0; };
  for (std::size_t from = 0, to = 0; from < rows.size(); from = to) {
    // Rows on which no mode acts do not end a segment.
    for (to = from + 1; to < rows.size(); ++to) {
      Index between = rows[to - 1] + 1;
      while (between < rows[to] && kept_apart(between)) ++between;
      if (between < rows[to]) break;
    }
    const std::vector<Index> own(rows.begin() + static_cast<std::ptrdiff_t>(from),
                                 rows.begin() + static_cast<std::ptrdiff_t>(to));
    const auto rms = [&own](const VectorXd& error) {
      return std::sqrt(error(own).squaredNorm() / static_cast<double>(own.size()));
    };
    const auto time = [&data](Index n) { return data.series->t[static_cast<std::size_t>(n)]; };
    stretches.push_back(
        {time(own.front()), time(own.back()), static_cast<long long>(own.size()), rms(before.error), rms(after.error)});
  }
  if (stretches.size() < 2 || stretches.size() > kMost) stretches.clear();
  return stretches;
}

void CloseInterval(const std::vector<Index>& rows, const WholeRun& before, const WholeRun& after, std::uint64_t seed,
                   gap::GapSummary* gap) {
  gap->closed_low = gap->closed_high = gap->closed_fraction;
  if (before.error.size() == 0 || after.error.size() == 0 || rows.size() < gap::kNumBlocks) return;
  const VectorXd first = gap::BlockSquares(before.error(rows)), second = gap::BlockSquares(after.error(rows));
  const double noise =
      gap->noise_floor * gap->noise_floor * static_cast<double>(rows.size()) / static_cast<double>(gap::kNumBlocks);
  const VectorXd total = first.array() - noise;
  if (!(total.sum() > 0.0)) return;
  const gap::BlockBootstrap bootstrap(seed);
  gap->closed_low = bootstrap.RatioQuantile(first - second, total, 0.025);
  gap->closed_high = bootstrap.RatioQuantile(first - second, total, 0.975);
}

void LeaveOutStarts(const Trial& trial, Dataset* data) {
  constexpr double kForgotten = 0.01, kMostOfRun = 0.1;
  const Eigen::Index forgets = trial.model->RowsToForget(trial.fit.theta, kForgotten);
  for (std::size_t r = 0; r < data->series->runs.size() && forgets > 0; ++r) {
    const std::size_t from = data->series->runs[r];
    const std::size_t to = r + 1 < data->series->runs.size() ? data->series->runs[r + 1] : data->series->num_rows();
    if (static_cast<double>(forgets) > kMostOfRun * static_cast<double>(to - from)) continue;
    for (std::size_t n = from; n < from + static_cast<std::size_t>(forgets); ++n)
      data->training[n] = data->held_out[n] = 0;
  }
}

gap::Figures FiguresOf(const Dataset& data, const WholeRun& before, const WholeRun* after,
                       const std::vector<Feature>& features, const SignalDescription& output) {
  constexpr std::size_t kPoints = 4000;
  gap::Figures figures;
  figures.output_title = output.name + (output.unit.empty() ? "" : ", " + output.unit);
  figures.measured = Over(data, before.model->target(), kPoints);
  figures.predicted_before = Over(data, before.prediction, kPoints);
  figures.residual_before = Over(data, before.error, kPoints);
  if (after != nullptr) {
    figures.predicted_after = Over(data, after->prediction, kPoints);
    figures.residual_after = Over(data, after->error, kPoints);
  }
  // A single segment at the end can be shaded; other splits are described in words.
  const auto first = std::find(data.held_out.begin(), data.held_out.end(), std::uint8_t{1});
  const bool tail = std::find(first, data.held_out.end(), std::uint8_t{0}) == data.held_out.end();
  figures.diagnosis_end_s =
      first != data.held_out.end() && tail
          ? data.series->t.front() + data.series->dt * static_cast<double>(first - data.held_out.begin())
          : std::numeric_limits<double>::quiet_NaN();
  std::vector<Index> rows;
  for (std::size_t n = 0; n < data.training.size(); ++n)
    if (data.training[n] != 0 && before.model->active()[n] != 0) rows.push_back(static_cast<Index>(n));
  for (const Feature& feature : features) {
    gap::FeatureFigure figure;
    figure.feature = feature.name + (feature.unit.empty() ? "" : ", " + feature.unit);
    figure.before = Binned(before.error, feature.value, rows);
    if (after != nullptr) figure.after = Binned(after->error, feature.value, rows);
    if (figure.before.x.size() > 2) figures.features.push_back(std::move(figure));
  }
  return figures;
}

}  // namespace armcmc::ladder
