#include "armcmc/gap/recording.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "armcmc/support/csv.hpp"
#include "armcmc/support/program.hpp"

namespace armcmc::gap {
namespace {

constexpr double kJitter = 0.01;  // of the sample interval, up to which the grid counts as even
constexpr double kHole = 1.5;     // sample intervals, from which samples are missing
constexpr double kMaxHoleShare = 0.01;

double MedianInterval(const Vector& t) {
  std::vector<double> intervals(static_cast<std::size_t>(t.size() - 1));
  for (Eigen::Index i = 1; i < t.size(); ++i) intervals[static_cast<std::size_t>(i - 1)] = t[i] - t[i - 1];
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

/// Linear interpolation on the grid t0 + i dt.
void Resample(Recording* recording) {
  const Vector t = recording->t;
  const auto rows = static_cast<Eigen::Index>(std::floor((t[t.size() - 1] - t[0]) / recording->dt + 1e-9)) + 1;
  recording->t = Vector::LinSpaced(rows, t[0], t[0] + static_cast<double>(rows - 1) * recording->dt);
  for (Vector& column : recording->columns) {
    const Vector old = column;
    column.resize(rows);
    Eigen::Index at = 0;
    for (Eigen::Index i = 0; i < rows; ++i) {
      while (at + 2 < t.size() && t[at + 1] < recording->t[i]) ++at;
      const double share = std::clamp((recording->t[i] - t[at]) / (t[at + 1] - t[at]), 0.0, 1.0);
      column[i] = old[at] + share * (old[at + 1] - old[at]);
    }
  }
}

/// Speeds in other units than positions, or of the other sign, spoil every effect of both.
void CompareUnits(const std::string& position, const std::string& velocity, Recording* recording) {
  constexpr double kAlike = 0.8;  // correlation from which the two belong together
  const auto has = [&](const std::string& name) {
    return std::find(recording->names.begin(), recording->names.end(), name) != recording->names.end();
  };
  if (!has(position) || !has(velocity)) return;
  const Vector& x = recording->Column(position);
  const Eigen::Index inner = x.size() - 2;
  const Vector rate = (x.tail(inner) - x.head(inner)) / (2.0 * recording->dt);
  const Vector v = recording->Column(velocity).segment(1, inner);
  const double product = rate.dot(v), correlation = product / (rate.norm() * v.norm() + 1e-300);
  const double ratio = v.squaredNorm() / product;
  if (std::abs(correlation) < kAlike || (ratio > 0.5 && ratio < 2.0)) return;
  char note[160];
  std::snprintf(note, sizeof(note), "%s is %.3g times the derivative of %s: check the units and signs of both",
                velocity.c_str(), ratio, position.c_str());
  recording->notes.emplace_back(note);
}

}  // namespace

const Vector& Recording::Column(const std::string& name) const {
  const auto it = std::find(names.begin(), names.end(), name);
  if (it == names.end()) throw std::invalid_argument(source + ": has no column " + name);
  return columns[static_cast<std::size_t>(it - names.begin())];
}

Recording Recording::Slice(Eigen::Index first, Eigen::Index count) const {
  Recording part = *this;
  part.t = t.segment(first, count);
  for (Vector& column : part.columns) column = Vector(column.segment(first, count));
  return part;
}

Recording ReadRecording(const std::string& path, const std::vector<std::string>& columns, bool skip_bad) {
  support::CsvRequest request;
  request.columns = columns;
  request.skip_bad = skip_bad;
  if (std::find(columns.begin(), columns.end(), "v") != columns.end()) request.derived = {{"v", "x"}};
  if (std::find(columns.begin(), columns.end(), "pdot") != columns.end()) request.derived = {{"pdot", "p"}};
  support::CsvSamples samples = support::ReadCsv(path, request);
  if (samples.num_rows() < 2)
    throw support::InputError(path + ": holds " + std::to_string(samples.num_rows()) +
                              " samples, expected a recording");
  Recording recording;
  recording.source = path;
  recording.notes = samples.notes;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const Vector column =
        Eigen::Map<const Vector>(samples.columns[c].data(), static_cast<Eigen::Index>(samples.columns[c].size()));
    if (c == 0) recording.t = column;
    recording.names.push_back(columns[c]);
    recording.columns.push_back(column);
  }
  recording.dt = MedianInterval(recording.t);
  Eigen::Index uneven = 0, holes = 0;
  for (Eigen::Index i = 1; i < recording.rows(); ++i) {
    const double interval = recording.t[i] - recording.t[i - 1];
    uneven += std::abs(interval - recording.dt) > kJitter * recording.dt ? 1 : 0;
    holes += interval > kHole * recording.dt ? 1 : 0;
  }
  const auto rows = static_cast<double>(recording.rows());
  if (static_cast<double>(holes) > kMaxHoleShare * rows)
    throw support::InputError(path + ": " + std::to_string(holes) +
                              " gaps between samples: expected even sampling, most rows one interval apart");
  if (uneven > 0) {
    Resample(&recording);
    recording.notes.push_back(std::to_string(uneven) + " of " + std::to_string(recording.rows()) +
                              " sample intervals are uneven: resampled by interpolation");
  }
  CompareUnits("x", "v", &recording);
  CompareUnits("p", "pdot", &recording);
  return recording;
}

}  // namespace armcmc::gap
