#include "armcmc/ladder/free_constants.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "armcmc/plant/error.hpp"
#include "armcmc/support/parallel.hpp"

namespace armcmc::ladder {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// The constant `name` times a number about 1.
EffectEntry EntryOf(const std::string& name) {
  EffectNeed need;
  need.name = "c";
  need.kind = "constant";
  EffectForm form;
  form.needs = {need};
  form.parameters.push_back({"off", "1", "normal", "0", "0.025", "-0.05", "0.05", "0"});
  form.terms.push_back({"parameter", "c", "c*(1 + off)"});
  EffectEntry entry;
  entry.name = entry.family = name;
  entry.forms = {form};
  return entry;
}

}  // namespace

std::optional<FreeConstants> WithFreeConstants(const PlantDescription& own, const std::shared_ptr<const Plant>& plant,
                                               const Dataset& data, const DataScales& scales,
                                               const std::vector<VectorXd>& known) {
  auto entries = std::make_shared<std::vector<EffectEntry>>();
  for (const ConstantDescription& constant : own.constants)
    if (constant.value != 0.0) entries->push_back(EntryOf(constant.name));
  FreeConstants free;
  free.plant = plant;
  for (const EffectEntry& entry : *entries) {
    const PlantDescription& so_far = free.plant->description();
    for (const EffectBinding& binding : Bindings(so_far, entry)) {
      if (binding.symbols.at("c") != entry.name) continue;
      try {
        auto with = std::make_shared<const Plant>(AddEffect(so_far, entry, binding, scales));
        free.candidates.push_back({&entry, binding, with, so_far.parameters.size()});
        free.constants.push_back(*std::find_if(own.constants.begin(), own.constants.end(),
                                               [&](const auto& c) { return c.name == entry.name; }));
        free.plant = std::move(with);
      } catch (const PlantError&) {  // a number that cannot vary
      }
      break;
    }
  }
  free.entries = std::move(entries);
  if (free.candidates.empty()) return std::nullopt;
  std::vector<Trial> trials(known.size());
  support::InParallel(known.size(), [&](std::size_t i) {
    VectorXd theta = identify::TrajectoryModel(free.plant, data.series).Start();
    theta.head(known[i].size()) = known[i];
    trials[i] = Refine(free.plant, data, theta);
  });
  for (Trial& trial : trials)
    if (trial.fit.valid && (!free.trial.fit.valid || trial.fit.cost < free.trial.fit.cost))
      free.trial = std::move(trial);
  if (!free.trial.fit.valid) return std::nullopt;
  return free;
}

std::string AsIf(const FreeConstants& free, const Trial& trial, const std::vector<std::uint8_t>& rows) {
  constexpr double kSigmas = 2.0;
  const VectorXd sd = identify::Covariance(*trial.model, rows, trial.fit).diagonal().cwiseSqrt();
  std::vector<std::string> sure, all;
  for (std::size_t k = 0; k < free.candidates.size(); ++k) {
    const auto d = static_cast<Index>(free.candidates[k].first_fitted());
    const double off = trial.fit.theta[d], value = free.constants[k].value;
    char one[160];
    std::snprintf(one, sizeof(one), "%s were %.4g instead of %.4g", free.constants[k].name.c_str(), value * (1.0 + off),
                  value);
    all.emplace_back(one);
    if (std::abs(off) > kSigmas * sd[d]) sure.emplace_back(one);
  }
  if (sure.empty()) sure = all;
  std::string text;
  for (std::size_t k = 0; k < sure.size(); ++k) {
    if (k > 0) text += k + 1 < sure.size() ? ", " : " and ";
    text += sure[k];
  }
  return text;
}

PlantDescription AddFreeConstants(PlantDescription plant, const FreeConstants& free, const DataScales& scales) {
  for (const Candidate& candidate : free.candidates) {
    try {
      plant = AddEffect(plant, *candidate.entry, candidate.binding, scales);
    } catch (const PlantError&) {  // no place for it
    }
  }
  return plant;
}

}  // namespace armcmc::ladder
