#include "armcmc/ladder/drift.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "widths.hpp"

namespace armcmc::ladder {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Rows of a segment, and the rows before it in the same run.
struct Stretch {
  std::size_t begin = 0, from = 0, to = 0;  // [begin, from) gives the history, [from, to) is fitted
};

std::vector<Stretch> StretchesOf(const identify::Series& series) {
  constexpr std::size_t kStretches = 10, kFewest = 100;
  const std::size_t length = std::max(kFewest, (series.num_rows() + kStretches - 1) / kStretches);
  std::vector<Stretch> stretches;
  for (std::size_t r = 0; r < series.runs.size(); ++r) {
    const std::size_t first = series.runs[r], end = r + 1 < series.runs.size() ? series.runs[r + 1] : series.num_rows();
    const std::size_t count = std::max<std::size_t>(1, (end - first + length / 2) / length);
    if (end - first < kFewest) continue;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t from = first + (end - first) * k / count, to = first + (end - first) * (k + 1) / count;
      stretches.push_back({from - std::min(from - first, to - from), from, to});
    }
  }
  return stretches;
}

Dataset Cut(const identify::Series& all, const Stretch& stretch) {
  auto series = std::make_shared<identify::Series>();
  const auto part = [&](const std::vector<double>& of) {
    return std::vector<double>(of.begin() + static_cast<std::ptrdiff_t>(stretch.begin),
                               of.begin() + static_cast<std::ptrdiff_t>(stretch.to));
  };
  series->dt = all.dt;
  series->t = part(all.t);
  for (const std::vector<double>& signal : all.signals) series->signals.push_back(part(signal));
  series->runs = {0};
  Dataset data;
  data.training.assign(stretch.from - stretch.begin, 0);
  data.training.resize(stretch.to - stretch.begin, 1);
  data.held_out.assign(data.training.size(), 0);
  data.series = std::move(series);
  return data;
}

/// Survival function of the chi-square distribution, by the Wilson-Hilferty approximation.
double ChiSquareTail(double value, double degrees) {
  const double share = 2.0 / (9.0 * degrees);
  return 0.5 * std::erfc((std::cbrt(value / degrees) - (1.0 - share)) / std::sqrt(2.0 * share));
}

/// Values of all parameters of a plant on the segments.
struct Followed {
  std::vector<ParameterDescription> parameters;
  std::vector<gap::Constancy> constancy;
};

/// @param fit  Fit of the plant with all parameters free.
Followed Follow(const Dataset& data, const std::vector<Stretch>& stretches, const PlantDescription& description,
                const Trial& fit) {
  constexpr double kTold = 0.8;  // of the prior's standard deviation: a wider band does not determine the parameter
  const auto plant = std::make_shared<const Plant>(description);
  Followed out;
  std::vector<std::vector<double>> value, sd;
  for (const Stretch& stretch : stretches) {
    const Dataset part = Cut(*data.series, stretch);
    Trial trial;
    trial.model = std::make_shared<const identify::TrajectoryModel>(plant, part.series);
    const auto count = static_cast<std::size_t>(trial.model->num_parameters());
    if (out.parameters.empty()) {
      out.parameters = trial.model->parameters();
      out.constancy.resize(count);
      value.resize(count);
      sd.resize(count);
    }
    VectorXd start = trial.model->Start();
    for (std::size_t d = 0; d < count; ++d)
      for (Index all = 0; all < fit.fit.theta.size(); ++all)
        if (fit.model->parameters()[static_cast<std::size_t>(all)].name == out.parameters[d].name)
          start[static_cast<Index>(d)] = fit.fit.theta[all];
    trial.fit = identify::Fit(*trial.model, part.training, start, 8);
    if (!trial.fit.valid) continue;
    const VectorXd width = Widths(trial, part.training, Correlated(trial, part.training)).Of(std::vector<bool>(count));
    const double middle =
        data.series->t.front() + 0.5 * static_cast<double>(stretch.from + stretch.to) * data.series->dt;
    for (std::size_t d = 0; d < count; ++d) {
      const auto i = static_cast<Index>(d);
      const double at = trial.fit.theta[i], reach = 1.96 * width[i];
      if (width[i] > kTold * trial.model->Spread()[i]) continue;
      value[d].push_back(at);
      sd[d].push_back(width[i]);
      gap::Curve& course = out.constancy[d].course;
      course.x.push_back(middle);
      course.y.push_back(trial.model->Shown(i, at));
      course.low.push_back(trial.model->Shown(i, std::max(at - reach, trial.model->Lower()[i])));
      course.high.push_back(trial.model->Shown(i, std::min(at + reach, trial.model->Upper()[i])));
    }
  }
  for (std::size_t d = 0; d < out.parameters.size(); ++d) {
    gap::Constancy& one = out.constancy[d];
    one.fitted = true;
    JudgeConstancy(value[d], sd[d], &one);
    if (out.parameters[d].prior != "lognormal") continue;
    one.mean = std::exp(one.mean);
    one.moves_by *= one.mean;
  }
  return out;
}

}  // namespace

void JudgeConstancy(const std::vector<double>& value, const std::vector<double>& sd, gap::Constancy* out) {
  constexpr double kRare = 0.01;
  double weights = 0.0, sum = 0.0, chi = 0.0;
  for (std::size_t k = 0; k < value.size(); ++k) {
    weights += 1.0 / (sd[k] * sd[k] + 1e-300);
    sum += value[k] / (sd[k] * sd[k] + 1e-300);
  }
  if (value.empty()) return;
  out->mean = sum / weights;
  if (value.size() < 2) return;
  for (std::size_t k = 0; k < value.size(); ++k) chi += std::pow((value[k] - out->mean) / (sd[k] + 1e-150), 2);
  const double degrees = static_cast<double>(value.size()) - 1.0;
  out->p_value = ChiSquareTail(chi, degrees);
  out->constant = out->p_value >= kRare;
  // The width of the overall band follows from the sum of the weights.
  const double usual = static_cast<double>(value.size()) / weights;
  out->moves_by = std::sqrt(std::max(0.0, chi / degrees - 1.0) * usual);
}

std::vector<gap::ParameterDrift> DriftOver(const Dataset& data, const TunedPlant& before, const Trial& base,
                                           const TunedPlant* after, const Trial& final_trial) {
  const std::vector<Stretch> stretches = StretchesOf(*data.series);
  std::vector<gap::ParameterDrift> drift;
  if (stretches.size() < 2) return drift;
  const auto entry = [&](const ParameterDescription& p) -> gap::ParameterDrift& {
    for (gap::ParameterDrift& one : drift)
      if (one.name == p.name) return one;
    gap::ParameterDrift& one = drift.emplace_back();
    one.name = p.name;
    one.unit = p.unit;
    return one;
  };
  Followed first = Follow(data, stretches, before.loose, base);
  for (std::size_t d = 0; d < first.parameters.size(); ++d)
    entry(first.parameters[d]).before = std::move(first.constancy[d]);
  if (after == nullptr) return drift;
  Followed second = Follow(data, stretches, after->loose, final_trial);
  for (std::size_t d = 0; d < second.parameters.size(); ++d)
    entry(second.parameters[d]).after = std::move(second.constancy[d]);
  return drift;
}

}  // namespace armcmc::ladder
