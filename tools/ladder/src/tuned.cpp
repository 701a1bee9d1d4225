#include "armcmc/ladder/tuned.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

#include "armcmc/settings.hpp"
#include "widths.hpp"

namespace armcmc::ladder {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// The plant with what is known as constants, and, where they are asked for, priors about the fit for the rest.
PlantDescription About(const PlantDescription& plant, const Trial& trial, const VectorXd& sd,
                       const std::vector<bool>& known, bool about_fit) {
  constexpr double kWider = 3.0;
  PlantDescription tuned = plant;
  for (Index d = 0; d < trial.fit.theta.size(); ++d) {
    const std::string& name = trial.model->parameters()[static_cast<std::size_t>(d)].name;
    const double value = trial.model->Shown(d, trial.fit.theta[d]);
    const auto at = std::find_if(tuned.parameters.begin(), tuned.parameters.end(),
                                 [&](const ParameterDescription& p) { return p.name == name; });
    if (at == tuned.parameters.end()) continue;  // each mode has one of its own
    if (known[static_cast<std::size_t>(d)]) {
      tuned.constants.push_back({name, value, at->unit});
      tuned.parameters.erase(at);
    } else if (about_fit && at->prior != "uniform") {
      at->mean = value;
      at->sd = std::clamp(kWider * sd[d], 1e-12 * at->sd, at->sd);
    }
  }
  if (about_fit) tuned.noise.std = std::max(trial.fit.error_sd, 1e-300);
  return tuned;
}

/// What the estimator runs. @return why it does not; empty: it does.
std::string Compile(const PlantDescription& plant, std::shared_ptr<const PlantProgram>* program) {
  try {
    auto made = std::make_shared<const PlantProgram>(std::make_shared<const Plant>(plant));
    DescribedSettings(made).Validate();
    *program = std::move(made);
    return {};
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace

TunedPlant Tuned(const PlantDescription& plant, std::size_t own, const Trial& trial,
                 const std::vector<std::uint8_t>& rows) {
  constexpr double kUntold = 0.25;  // of the prior's standard deviation
  constexpr double kPressed = 0.1;  // of what the data leave open: on a bound
  const Widths widths(trial, rows);
  const VectorXd prior = trial.model->Spread();
  // Of the fitted parameters those of the plant itself come first, also where modes have their own.
  const auto size = static_cast<std::size_t>(trial.fit.theta.size());
  const std::size_t first = size - std::min(size, plant.parameters.size() - std::min(own, plant.parameters.size()));
  std::vector<bool> known(size, false);
  const VectorXd to_bound = (trial.fit.theta - trial.model->Lower()).cwiseMin(trial.model->Upper() - trial.fit.theta);
  const VectorXd open = widths.Of(known);
  for (std::size_t d = 0; d < size; ++d) {
    const auto i = static_cast<Index>(d);
    const std::string& name = trial.model->parameters()[d].name;
    const bool one = std::any_of(plant.parameters.begin(), plant.parameters.end(),
                                 [&](const ParameterDescription& p) { return p.name == name; });
    known[d] = one && to_bound[i] < kPressed * open[i];
  }
  for (TunedPlant tuned;;) {
    const VectorXd sd = widths.Of(known);
    std::size_t widest = size;
    double share = 0.0;
    for (std::size_t d = first; d < size; ++d) {
      const auto i = static_cast<Index>(d);
      if (known[d] || !(sd[i] / prior[i] > share)) continue;
      widest = d;
      share = sd[i] / prior[i];
    }
    if (share > kUntold) {
      known[widest] = true;
      continue;
    }
    tuned.plant = About(plant, trial, sd, known, true);
    tuned.why_not = Compile(tuned.plant, &tuned.program);
    if (!tuned.why_not.empty() && widest < size) {
      known[widest] = true;
      continue;
    }
    tuned.loose = About(plant, trial, sd, known, false);
    for (std::size_t d = 0; d < size; ++d)
      if (known[d]) tuned.held.push_back(trial.model->parameters()[d].name);
    return tuned;
  }
}

}  // namespace armcmc::ladder
