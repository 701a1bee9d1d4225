#include "armcmc/ladder/trial.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace armcmc::ladder {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kRidge = 1.0;

/// Values of the first signal with the parameter's unit that moves, sorted; empty: there is none.
std::vector<double> PlacesOf(const identify::TrajectoryModel& model, const Dataset& data,
                             const ParameterDescription& parameter) {
  const PlantDescription& plant = model.plant().description();
  for (std::size_t s = 0; s < plant.signals.size(); ++s) {
    if (static_cast<int>(s) == model.plant().output() || plant.signals[s].unit != parameter.unit) continue;
    std::vector<double> values;
    for (std::size_t n = 0; n < data.series->num_rows(); ++n)
      if (data.training[n] != 0) values.push_back(data.series->signals[s][n]);
    std::sort(values.begin(), values.end());
    if (!values.empty() && values.front() < values.back()) return values;
  }
  return {};
}

/// Angular frequency along x at which errors have most power, by a plain periodogram.
double StrongestFrequency(const VectorXd& error, const VectorXd& x) {
  constexpr Index kMost = 4000;
  const double range = x.maxCoeff() - x.minCoeff();
  double strongest = 0.0, power = 0.0;
  // Past the highest frequency that so many rows can tell there is nothing to seek.
  const Index last = std::min(kMost, 2 * x.size());
  for (Index half_turns = 2; half_turns < last; ++half_turns) {
    const double w = std::numbers::pi * static_cast<double>(half_turns) / range;
    const double c = error.dot(VectorXd((w * x).array().cos())), s = error.dot(VectorXd((w * x).array().sin()));
    if (c * c + s * s > power) {
      power = c * c + s * s;
      strongest = w;
    }
  }
  return strongest;
}

/// Starts at the strongest frequency of what the smaller model leaves, for parameters that are one over time, a signal
/// or a state: a fit finds a frequency only from next to it.
void AddFrequencies(const identify::TrajectoryModel& model, const Dataset& data, Index first,
                    std::vector<VectorXd>* starts) {
  const PlantDescription& plant = model.plant().description();
  const VectorXd start = starts->front();
  VectorXd prediction;
  for (Index d = first; d < start.size(); ++d) {
    const ParameterDescription& p = model.parameters()[static_cast<std::size_t>(d)];
    if (p.prior != "lognormal" || !p.unit.starts_with("1/") || !model.PredictOne(start, &prediction)) continue;
    std::vector<Index> rows;
    for (std::size_t n = 0; n < data.training.size(); ++n)
      if (data.training[n] != 0 && model.active()[n] != 0) rows.push_back(static_cast<Index>(n));
    const VectorXd error = (model.target() - prediction)(rows);
    const auto try_along = [&](const std::string& unit, const VectorXd& along) {
      if ((p.unit != "1/" + unit && p.unit != "1/(" + unit + ")") || !(along.maxCoeff() > along.minCoeff())) return;
      VectorXd more = start;
      more[d] = std::log(StrongestFrequency(error, along(rows)));
      starts->push_back(more.cwiseMax(model.Lower()).cwiseMin(model.Upper()));
    };
    const auto size = static_cast<Index>(model.num_rows());
    try_along("s", Eigen::Map<const VectorXd>(model.series().t.data(), size));
    for (std::size_t s = 0; s < plant.signals.size(); ++s)
      if (static_cast<int>(s) != model.plant().output())
        try_along(plant.signals[s].unit, Eigen::Map<const VectorXd>(model.series().signals[s].data(), size));
    if (plant.states.empty()) continue;
    const Eigen::MatrixXd states = model.States(start);
    for (std::size_t s = 0; s < plant.states.size(); ++s)
      try_along(plant.states[s].unit, states.col(static_cast<Index>(s)));
  }
}

/// Precision of the prior, and what it pulls with at a fit.
struct Pull {
  Eigen::VectorXd precision, gradient;
};

Pull PriorPull(const identify::TrajectoryModel& model, const identify::FitResult& fit) {
  const Eigen::VectorXd precision = identify::PriorPrecision(model);
  return {precision, precision.cwiseProduct(model.Start() - fit.theta)};
}

/// Squared error of a group, predicted by law and flexible function together, fitted to the other rows.
double SquareBeside(const Eigen::VectorXd& error, const Eigen::MatrixXd& jacobian, const Pull& pull, const View& view,
                    const RowGroup& group) {
  const Eigen::Index parameters = jacobian.cols(), features = view.flexible.cols();
  Eigen::MatrixXd joint(jacobian.rows(), parameters + features);
  joint << jacobian, view.flexible;
  const Eigen::MatrixXd part = joint(group.rows, Eigen::all);
  const Eigen::VectorXd group_error = error(group.rows);
  const double square = std::max(
      (error.squaredNorm() - group_error.squaredNorm()) / static_cast<double>(error.size() - group_error.size()),
      1e-300);
  Eigen::MatrixXd matrix = joint.transpose() * joint - part.transpose() * part;
  matrix.diagonal().head(parameters) += square * pull.precision;
  matrix.diagonal().tail(features).array() += kRidge;
  Eigen::VectorXd right = joint.transpose() * error - part.transpose() * group_error;
  right.head(parameters) += square * pull.gradient;
  const Eigen::VectorXd size = matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = size.asDiagonal() * matrix * size.asDiagonal();
  scaled.diagonal().array() += 1e-9;
  const Eigen::VectorXd step = size.cwiseProduct(scaled.ldlt().solve(size.cwiseProduct(right)));
  return (group_error - part * step).squaredNorm();
}

}  // namespace

std::vector<Eigen::VectorXd> Starts(const identify::TrajectoryModel& model, const Dataset& data,
                                    const Eigen::VectorXd& known, std::size_t count) {
  const Eigen::VectorXd centre = model.Start(), spread = model.Spread(), lower = model.Lower(), upper = model.Upper();
  std::vector<std::vector<double>> places;
  for (const ParameterDescription& p : model.parameters()) places.push_back(PlacesOf(model, data, p));
  std::mt19937_64 random(977);
  const auto uniform = [&] { return (static_cast<double>(random() >> 11U) + 0.5) * 0x1p-53; };
  std::vector<Eigen::VectorXd> starts;
  for (std::size_t s = 0; s < count; ++s) {
    Eigen::VectorXd start = centre;
    for (Eigen::Index d = 0; d < start.size(); ++d) {
      const double share = uniform(), side = uniform();
      if (d < known.size()) {
        start[d] = known[d];
      } else if (s > 0) {
        const std::vector<double>& place = places[static_cast<std::size_t>(d)];
        start[d] += 2.0 * (share - 0.5) * 1.5 * spread[d];
        if (!place.empty() && side < 0.7)
          start[d] = place[static_cast<std::size_t>(share * static_cast<double>(place.size()))];
      }
    }
    starts.push_back(start.cwiseMax(lower).cwiseMin(upper));
  }
  if (count > 1) AddFrequencies(model, data, known.size(), &starts);
  return starts;
}

bool IsSimulated(const PlantDescription& plant) {
  // States that an effect brings along have no role.
  return std::any_of(plant.states.begin(), plant.states.end(),
                     [](const StateDescription& s) { return !s.role.empty(); });
}

Dataset QuickPart(const Plant& plant, const Dataset& data, const Eigen::VectorXd& error) {
  constexpr std::size_t kRows = 3000, kLong = 500, kShort = 50;
  if (IsSimulated(plant.description())) return Beginnings(data, kRows);
  bool remembers = !plant.states().empty();
  for (const PlantMode& mode : plant.modes()) remembers = remembers || plant.graph().at(mode.law).memory;
  return remembers ? Windows(data, error, kLong, 2 * kRows) : Windows(data, error, kShort, kRows);
}

Trial Try(const std::shared_ptr<const Plant>& plant, const Dataset& data, const Eigen::VectorXd& known,
          std::size_t starts) {
  constexpr int kIterations = 12;
  constexpr std::size_t kFits = 3;
  Trial trial;
  trial.model = std::make_shared<const identify::TrajectoryModel>(plant, data.series);
  trial.fit =
      identify::BestFit(*trial.model, data.training, Starts(*trial.model, data, known, starts), kFits, kIterations);
  return trial;
}

Trial Refine(const std::shared_ptr<const Plant>& plant, const Dataset& data, const Eigen::VectorXd& theta) {
  Trial trial;
  trial.model = std::make_shared<const identify::TrajectoryModel>(plant, data.series);
  trial.fit = identify::Fit(*trial.model, data.training, theta);
  return trial;
}

void LeaveOut(const View& view, Trial* trial) {
  constexpr int kIterations = 6;
  trial->alone.clear();
  trial->beside.clear();
  trial->rest.clear();
  trial->stretches.assign(static_cast<std::size_t>(view.num_stretches), 0.0);
  trial->judged = true;
  for (const RowGroup& group : view.groups) {
    std::vector<std::uint8_t> rest(trial->model->num_rows(), 0);
    for (const Eigen::Index n : view.looked_at) rest[static_cast<std::size_t>(n)] = 1;
    for (const Eigen::Index k : group.rows)
      rest[static_cast<std::size_t>(view.looked_at[static_cast<std::size_t>(k)])] = 0;
    identify::FitResult fit = identify::Fit(*trial->model, rest, trial->fit.theta, kIterations);
    if (!fit.valid) fit = trial->fit;
    const Eigen::VectorXd error = (trial->model->target() - fit.prediction)(view.looked_at);
    trial->alone.push_back(error(group.rows).squaredNorm());
    trial->rest.push_back(error.squaredNorm() - trial->alone.back());
    trial->beside.push_back(
        SquareBeside(error, fit.jacobian(view.looked_at, Eigen::all), PriorPull(*trial->model, fit), view, group));
    if (group.kind != GroupKind::kFold) continue;
    for (const Eigen::Index k : group.rows)
      trial->stretches[static_cast<std::size_t>(view.stretch[static_cast<std::size_t>(k)])] += error[k] * error[k];
  }
}

}  // namespace armcmc::ladder
