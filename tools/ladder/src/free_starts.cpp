#include "free_starts.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace armcmc::ladder {
namespace {

constexpr double kForgotten = 0.01;   // of the most that a start changes,
constexpr double kMostOfRun = 0.5;    // in more of the rows than that; where a state begins with a number, or several
constexpr double kMostGuessed = 0.1;  // begin so, than that; else these rows are left out (see LeaveOutStarts)

/// @param which  States whose starts are freed.
PlantDescription WithFreeStartsOf(PlantDescription plant, const std::set<std::string>& which,
                                  const DataScales& scales) {
  for (StateDescription& state : plant.states) {
    if (!which.contains(state.name)) continue;
    const auto size = scales.quantity.find(state.name);
    const double rms = size == scales.quantity.end() ? 1.0 : size->second.rms;
    FreeStart(&state, rms, &plant);
  }
  return plant;
}

}  // namespace

void FreeStart(StateDescription* state, double sd, PlantDescription* plant) {
  ParameterDescription error;
  error.name = state->name + "_start";
  error.unit = state->unit;
  error.sd = sd;
  state->start = "(" + state->start + ") + " + error.name;
  plant->parameters.push_back(std::move(error));
}

std::shared_ptr<const Plant> WithFreeStarts(const Trial& trial, const Dataset& data, double noise) {
  if (data.series->runs.size() > 1) return nullptr;
  const PlantDescription& own = trial.model->plant().description();
  const DataScales scales = ScalesOf(data, own, noise);
  const auto begin_so = std::count_if(own.states.begin(), own.states.end(),
                                      [&](const StateDescription& state) { return state.start == own.output; });
  std::set<std::string> felt;
  for (const StateDescription& state : own.states) {
    const bool number = !state.start.empty() && state.start.find_first_not_of("0123456789.+-eE") == std::string::npos;
    if (state.start != own.output && !number) continue;
    const identify::TrajectoryModel model(std::make_shared<const Plant>(WithFreeStartsOf(own, {state.name}, scales)),
                                          data.series);
    Eigen::VectorXd theta = model.Start(), prediction;
    theta.head(trial.fit.theta.size()) = trial.fit.theta;
    Eigen::MatrixXd jacobian;
    if (!model.Linearise(theta, &prediction, &jacobian)) continue;
    std::vector<double> change;
    for (std::size_t n = 0; n < data.training.size(); ++n)
      if (data.training[n] != 0 && model.active()[n] != 0)
        change.push_back(std::fabs(jacobian(static_cast<Eigen::Index>(n), jacobian.cols() - 1)));
    if (change.empty()) continue;
    const double most = *std::max_element(change.begin(), change.end());
    std::size_t rows = change.size();
    while (rows > 0 && !(change[rows - 1] > kForgotten * most)) --rows;
    const double most_of_run = number || begin_so > 1 ? kMostGuessed : kMostOfRun;
    if (static_cast<double>(rows) > most_of_run * static_cast<double>(change.size())) felt.insert(state.name);
  }
  return felt.empty() ? nullptr : std::make_shared<const Plant>(WithFreeStartsOf(own, felt, scales));
}

PlantDescription WithOwnStarts(PlantDescription plant, const PlantDescription& own) {
  for (const StateDescription& state : own.states) {
    const auto freed = std::find_if(plant.states.begin(), plant.states.end(),
                                    [&](const StateDescription& s) { return s.name == state.name; });
    if (freed == plant.states.end() || freed->start == state.start) continue;
    freed->start = state.start;
    std::erase_if(plant.parameters, [&](const ParameterDescription& p) { return p.name == state.name + "_start"; });
  }
  return plant;
}

}  // namespace armcmc::ladder
