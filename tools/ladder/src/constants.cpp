#include "constants.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "armcmc/plant/error.hpp"
#include "armcmc/support/parallel.hpp"
#include "comparison.hpp"

namespace armcmc::ladder {
namespace {

constexpr double kConstantOff = 0.05;  // of a constant, at most
constexpr double kExplainsIt = 1.05;   // times the squared error that an effect leaves

/// A constant times a number about 1.
EffectEntry OffEntry() {
  EffectNeed need;
  need.name = "c";
  need.kind = "constant";
  EffectForm form;
  form.needs = {need};
  const std::string most = std::to_string(kConstantOff);
  form.parameters.push_back({"e", "1", "uniform", "0", "", "-" + most, most, "0"});
  form.terms.push_back({"parameter", "c", "c*(1 + e)"});
  EffectEntry entry;
  entry.name = entry.family = "off";
  entry.forms = {form};
  return entry;
}

}  // namespace

Constants::Constants(const PlantDescription& own, const std::shared_ptr<const Plant>& plant, const Dataset& data,
                     const View& view, const Trial& base, const DataScales& scales)
    : own_(own), plant_(plant), data_(data), view_(view), base_(base), scales_(scales), entries_{OffEntry()} {}

void Constants::FitThem() {
  std::vector<std::string> notes;  // what does not fit a limit is no rival
  std::vector<Other> all;
  for (Candidate& candidate : Candidates(plant_->description(), entries_, scales_, &notes)) {
    const std::string& name = candidate.binding.symbols.at("c");
    const auto own = std::find_if(own_.constants.begin(), own_.constants.end(),
                                  [&](const ConstantDescription& c) { return c.name == name; });
    if (own == own_.constants.end() || own->value == 0.0) continue;
    all.push_back(
        {name, own->value, own->value, {std::move(candidate), {}, false, 0.0, {}, {}, 0.0, 0.0, false, false, false}});
  }
  support::InParallel(all.size(), [&](std::size_t i) {
    Contender& c = all[i].contender;
    try {
      Eigen::VectorXd theta = identify::TrajectoryModel(c.candidate.plant, data_.series).Start();
      theta.head(base_.fit.theta.size()) = base_.fit.theta;
      c.trial = Refine(c.candidate.plant, data_, theta);
      if (!c.trial.fit.valid) return;
      LeaveOut(view_, &c.trial);
      c.alone = Compare(view_, c, base_, false);
      c.refined = true;
      all[i].is *= 1.0 + c.trial.fit.theta[theta.size() - 1];
    } catch (const PlantError&) {  // needs more than there is room for
    }
  });
  fitted_ = std::move(all);
}

std::optional<Rival> Constants::RivalOf(const Contender& c) {
  if (!fitted_) FitThem();
  for (const Other& other : *fitted_) {
    if (!other.contender.refined || other.contender.alone.folds > kExplainsIt * c.alone.folds) continue;
    char text[160];
    std::snprintf(text, sizeof(text), "%s were %.4g instead of %.4g", other.name.c_str(), other.is, other.was);
    return Rival{text, "explains as much"};
  }
  return std::nullopt;
}

}  // namespace armcmc::ladder
