#include "armcmc/ladder/dataset.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace armcmc::ladder {
namespace {

/// First row after the run that begins at runs[r].
std::size_t EndOfRun(const identify::Series& series, std::size_t r) {
  return r + 1 < series.runs.size() ? series.runs[r + 1] : series.num_rows();
}

}  // namespace

std::size_t Dataset::num_training() const {
  return static_cast<std::size_t>(std::count(training.begin(), training.end(), std::uint8_t{1}));
}

Dataset DatasetOf(const support::Recording& recording) {
  auto series = std::make_shared<identify::Series>();
  series->dt = recording.dt;
  series->t = recording.t;
  series->runs = recording.runs;
  for (const support::RecordedSignal& signal : recording.signals) series->signals.push_back(signal.value);
  Dataset data;
  data.held_out = recording.held_out;
  for (const std::uint8_t held_out : data.held_out) data.training.push_back(held_out == 0 ? 1 : 0);
  data.series = std::move(series);
  return data;
}

Dataset Beginnings(const Dataset& data, std::size_t rows) {
  const identify::Series& all = *data.series;
  std::vector<std::size_t> length(all.runs.size(), 0);
  std::size_t total = 0;
  for (std::size_t r = 0; r < all.runs.size(); ++r) {
    for (std::size_t n = all.runs[r]; n < EndOfRun(all, r); ++n)
      if (data.training[n] != 0) length[r] = n + 1 - all.runs[r];
    total += length[r];
  }
  const double share = std::min(1.0, static_cast<double>(rows) / static_cast<double>(std::max<std::size_t>(total, 1)));
  auto series = std::make_shared<identify::Series>();
  series->dt = all.dt;
  series->signals.resize(all.signals.size());
  Dataset out;
  for (std::size_t r = 0; r < all.runs.size(); ++r) {
    const auto kept = static_cast<std::size_t>(std::ceil(share * static_cast<double>(length[r])));
    if (kept == 0) continue;
    series->runs.push_back(series->t.size());
    for (std::size_t n = all.runs[r]; n < all.runs[r] + kept; ++n) {
      series->t.push_back(all.t[n]);
      for (std::size_t s = 0; s < all.signals.size(); ++s) series->signals[s].push_back(all.signals[s][n]);
      out.training.push_back(data.training[n]);
    }
  }
  out.held_out.assign(out.training.size(), 0);
  out.series = std::move(series);
  return out;
}

Dataset Windows(const Dataset& data, const Eigen::VectorXd& error, std::size_t length, std::size_t rows) {
  const identify::Series& all = *data.series;
  if (all.num_rows() <= rows) return data;
  const std::size_t places = (all.num_rows() + length - 1) / length, count = std::max<std::size_t>(rows / length, 2);
  // Without errors, all segments are spread over the data.
  const std::size_t even = error.size() > 0 ? count / 2 : count;
  std::vector<double> energy(places, 0.0);
  for (std::size_t n = 0; n < all.num_rows() && error.size() > 0; ++n)
    if (data.training[n] != 0) energy[n / length] += std::pow(error[static_cast<Eigen::Index>(n)], 2);
  std::vector<std::size_t> order(places);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return energy[a] > energy[b]; });
  std::vector<bool> chosen(places, false);
  for (std::size_t w = 0; w < even; ++w) chosen[w * (places - 1) / std::max<std::size_t>(even - 1, 1)] = true;
  for (std::size_t w = 0, more = count - even; w < places && more > 0; ++w)
    if (!chosen[order[w]]) {
      chosen[order[w]] = true;
      --more;
    }
  auto series = std::make_shared<identify::Series>();
  series->dt = all.dt;
  series->signals.resize(all.signals.size());
  Dataset out;
  std::size_t next_run = 0;
  for (std::size_t n = 0; n < all.num_rows(); ++n) {
    const bool begins = next_run < all.runs.size() && all.runs[next_run] == n;
    if (begins) ++next_run;
    if (!chosen[n / length]) continue;
    if (begins || n == 0 || (n % length == 0 && !chosen[n / length - 1])) series->runs.push_back(series->t.size());
    series->t.push_back(all.t[n]);
    for (std::size_t s = 0; s < all.signals.size(); ++s) series->signals[s].push_back(all.signals[s][n]);
    out.training.push_back(data.training[n]);
  }
  out.held_out.assign(out.training.size(), 0);
  out.series = std::move(series);
  return out;
}

DataScales ScalesOf(const Dataset& data, const PlantDescription& plant, double noise) {
  const identify::Series& series = *data.series;
  std::vector<std::vector<double>> columns(series.signals.size());
  std::vector<double> times;
  for (std::size_t n = 0; n < series.num_rows(); ++n) {
    if (data.training[n] == 0) continue;
    for (std::size_t s = 0; s < columns.size(); ++s) columns[s].push_back(series.signals[s][n]);
    // Time may restart in every run; its scale is the total duration.
    times.push_back(series.t.front() + series.dt * static_cast<double>(times.size()));
  }
  DataScales scales = MeasuredScales(plant, columns, times);
  scales.noise = noise;
  return scales;
}

double NoiseFloor(const Dataset& data, const Eigen::VectorXd& target, const std::vector<std::uint8_t>& active) {
  const identify::Series& series = *data.series;
  double square = 0.0;
  std::size_t count = 0;
  for (std::size_t r = 0; r < series.runs.size(); ++r)
    for (std::size_t n = series.runs[r] + 3; n < EndOfRun(series, r); ++n) {
      if (data.training[n] == 0 || active[n] == 0 || active[n - 3] == 0) continue;
      const auto at = static_cast<Eigen::Index>(n);
      square += std::pow(target[at] - 3.0 * target[at - 1] + 3.0 * target[at - 2] - target[at - 3], 2);
      ++count;
    }
  return count > 0 ? std::sqrt(square / (20.0 * static_cast<double>(count))) : 0.0;
}

}  // namespace armcmc::ladder
