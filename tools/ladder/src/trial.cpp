#include "armcmc/ladder/trial.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>

#include "frequencies.hpp"
#include "held_out.hpp"

namespace armcmc::ladder {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kRidge = 1.0;

/// Sorted values of the first non-constant signal with the unit of the parameter; empty if there is none.
std::vector<double> CandidatePlaces(const identify::TrajectoryModel& model, const Dataset& data,
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

/// Law and flexible function fitted together, linearised about fits that leave out one group each.
class JointFit {
 public:
  JointFit(const identify::TrajectoryModel& model, const View& view)
      : flexible_(view.flexible),
        gram_(view.flexible.transpose() * view.flexible),
        precision_(identify::PriorPrecision(model)),
        centre_(model.Start()) {}

  /// Squared error on a left-out group.
  /// @param theta, error, jacobian  Of the law alone, fitted without the group.
  [[nodiscard]] double Square(const VectorXd& theta, const VectorXd& error, const Eigen::MatrixXd& jacobian,
                              const RowGroup& group) const {
    const Index parameters = precision_.size(), features = flexible_.cols();
    Eigen::MatrixXd part(static_cast<Index>(group.rows.size()), parameters + features);
    part << jacobian(group.rows, Eigen::all), flexible_(group.rows, Eigen::all);
    const VectorXd group_error = error(group.rows);
    const double square = std::max(
        (error.squaredNorm() - group_error.squaredNorm()) / static_cast<double>(error.size() - group_error.size()),
        1e-300);
    Eigen::MatrixXd matrix(parameters + features, parameters + features);
    matrix.topLeftCorner(parameters, parameters) = jacobian.transpose() * jacobian;
    matrix.bottomLeftCorner(features, parameters) = flexible_.transpose() * jacobian;
    matrix.topRightCorner(parameters, features) = matrix.bottomLeftCorner(features, parameters).transpose();
    matrix.bottomRightCorner(features, features) = gram_;
    matrix -= part.transpose() * part;
    matrix.diagonal().head(parameters) += square * precision_;
    matrix.diagonal().tail(features).array() += kRidge;
    VectorXd right(parameters + features);
    right << jacobian.transpose() * error, flexible_.transpose() * error;
    right -= part.transpose() * group_error;
    right.head(parameters) += square * precision_.cwiseProduct(centre_ - theta);
    const VectorXd size = matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    Eigen::MatrixXd scaled = size.asDiagonal() * matrix * size.asDiagonal();
    scaled.diagonal().array() += 1e-9;
    const VectorXd step = size.cwiseProduct(scaled.ldlt().solve(size.cwiseProduct(right)));
    return (group_error - part * step).squaredNorm();
  }

 private:
  const Eigen::MatrixXd& flexible_;
  Eigen::MatrixXd gram_;
  VectorXd precision_, centre_;
};

/// The deviation of the output from its mean: stands in for a residual before the first fit.
Eigen::VectorXd Deviation(const Dataset& data, const Plant& plant) {
  const std::vector<double>& output = data.series->signals[static_cast<std::size_t>(plant.output())];
  const Eigen::VectorXd value =
      Eigen::Map<const Eigen::VectorXd>(output.data(), static_cast<Eigen::Index>(output.size()));
  return value.array() - value.mean();
}

}  // namespace

std::vector<Eigen::VectorXd> Starts(const identify::TrajectoryModel& model, const Dataset& data,
                                    const Eigen::VectorXd& known, std::size_t count,
                                    const std::vector<Frequency>& frequencies) {
  const Eigen::VectorXd centre = model.Start(), spread = model.Spread(), lower = model.Lower(), upper = model.Upper();
  std::vector<std::vector<double>> places;
  for (const ParameterDescription& p : model.parameters()) places.push_back(CandidatePlaces(model, data, p));
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
  AddFrequencies(model, data, frequencies, &starts);
  return starts;
}

bool IsSimulated(const PlantDescription& plant) {
  // States of added effects have no role.
  return std::any_of(plant.states.begin(), plant.states.end(),
                     [](const StateDescription& s) { return !s.role.empty(); });
}

bool Remembers(const Plant& plant) {
  return !plant.states().empty() || std::any_of(plant.modes().begin(), plant.modes().end(), [&](const PlantMode& mode) {
    return plant.graph().at(mode.law).memory;
  });
}

Dataset SubsetForFits(const Plant& plant, const Dataset& data, const Eigen::VectorXd& error) {
  constexpr std::size_t kRows = 3000, kLong = 500, kShort = 50;
  if (IsSimulated(plant.description())) return Beginnings(data, kRows);
  return Remembers(plant) ? Windows(data, error, kLong, 2 * kRows) : Windows(data, error, kShort, kRows);
}

Trial Try(const std::shared_ptr<const Plant>& plant, const Dataset& data, const Eigen::VectorXd& known,
          std::size_t starts, const std::vector<Frequency>& frequencies) {
  constexpr int kIterations = 12;
  constexpr std::size_t kFits = 3;
  Trial trial;
  trial.model = std::make_shared<const identify::TrajectoryModel>(plant, data.series);
  trial.fit = identify::BestFit(*trial.model, data.training, Starts(*trial.model, data, known, starts, frequencies),
                                kFits, kIterations, known.size() == 0);
  return trial;
}

Dataset Compared(const Plant& plant, const Dataset& data, std::size_t most_simulated) {
  constexpr std::size_t kMost = 20'000, kWindow = 1000;  // long enough for a law with memory
  return IsSimulated(plant.description()) ? Beginnings(data, most_simulated) : Windows(data, {}, kWindow, kMost);
}

Trial FitAlone(const std::shared_ptr<const Plant>& plant, Dataset* data) {
  constexpr std::size_t kStarts = 24;
  Trial trial = Try(plant, SubsetForFits(*plant, *data, Deviation(*data, *plant)), {}, kStarts);
  if (!trial.fit.valid) return trial;
  trial = Refine(plant, *data, trial.fit.theta);
  LeaveOutStarts(trial, data);
  return Refine(plant, *data, trial.fit.theta);
}

Trial Refine(const std::shared_ptr<const Plant>& plant, const Dataset& data, const Eigen::VectorXd& theta) {
  Trial trial;
  trial.model = std::make_shared<const identify::TrajectoryModel>(plant, data.series);
  trial.fit = identify::Fit(*trial.model, data.training, theta);
  return trial;
}

void LeaveOut(const View& view, Trial* trial) {
  trial->alone.clear();
  trial->with_flexible.clear();
  trial->rest.clear();
  trial->stretches.assign(static_cast<std::size_t>(view.num_stretches), 0.0);
  trial->judged = true;
  std::vector<std::vector<Index>> groups;
  for (const RowGroup& group : view.groups) groups.push_back(group.rows);
  const identify::FitsWithout fits = identify::FitWithoutEach(*trial->model, trial->fit, view.active_rows, groups);
  const JointFit joint(*trial->model, view);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const VectorXd theta = fits.theta.col(static_cast<Index>(g)), error = fits.error.col(static_cast<Index>(g));
    const RowGroup& group = view.groups[g];
    trial->alone.push_back(error(group.rows).squaredNorm());
    trial->rest.push_back(error.squaredNorm() - trial->alone.back());
    trial->with_flexible.push_back(joint.Square(theta, error, fits.jacobian[g], group));
    if (group.kind != GroupKind::kFold) continue;
    for (const Index k : group.rows)
      trial->stretches[static_cast<std::size_t>(view.stretch[static_cast<std::size_t>(k)])] += error[k] * error[k];
  }
}

}  // namespace armcmc::ladder
