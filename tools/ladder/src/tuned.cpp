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

/// The plant with the known parameters as constants and, if requested, priors centred on the fit for the others.
PlantDescription About(const PlantDescription& plant, const Trial& trial, const VectorXd& sd,
                       const std::vector<bool>& known, bool about_fit) {
  constexpr double kWider = 3.0;
  PlantDescription tuned = plant;
  for (Index d = 0; d < trial.fit.theta.size(); ++d) {
    const std::string& name = trial.model->parameters()[static_cast<std::size_t>(d)].name;
    const double value = trial.model->Shown(d, trial.fit.theta[d]);
    const auto at = std::find_if(tuned.parameters.begin(), tuned.parameters.end(),
                                 [&](const ParameterDescription& p) { return p.name == name; });
    if (at == tuned.parameters.end()) continue;  // each mode has its own copy
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

/// Compiles the plant for the estimator. @return the reason if it cannot run it; empty if it can.
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
  constexpr double kUntold = 0.25;  // of the prior's standard deviation: wider is not determined
  constexpr double kPressed = 0.1;  // of the posterior standard deviation: closer to a bound counts as at the bound
  const Widths widths(trial, rows);
  const VectorXd prior = trial.model->Spread();
  // The plant's own parameters come first among the fitted ones, including the copies of each mode.
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
