#include "bent_law.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "action.hpp"
#include "armcmc/ladder/features.hpp"
#include "armcmc/plant/error.hpp"
#include "armcmc/support/parallel.hpp"
#include "comparison.hpp"
#include "one_step.hpp"

namespace armcmc::ladder {
namespace {

constexpr const char* kMostBent = "0.33";  // of a parameter: formulas for the same physics differ by this much

EffectEntry BentEntry() {
  EffectEntry entry;
  entry.name = entry.family = "bent";
  for (const char* const kind : {"signal", "state"}) {
    EffectNeed p, x;
    p.name = "p";
    p.kind = "parameter";
    p.used = true;
    x.name = "x";
    x.kind = kind;
    EffectForm form;
    form.variant = true;  // all forms are tried
    form.needs = {p, x};
    form.constants = {{"m", "x", "low_x + 0.5*range_x"}, {"w", "x", "0.5*range_x"}};
    form.parameters.push_back({"e", "1", "uniform", "0", "", std::string("-") + kMostBent, kMostBent, "0"});
    form.terms.push_back({"parameter", "p", "p*(1 + e*(x - m)/w)"});
    entry.forms.push_back(std::move(form));
  }
  return entry;
}

}  // namespace

BentLaw::BentLaw(const std::shared_ptr<const Plant>& plant, const Dataset& data, const View& view, const Trial& base,
                 const DataScales& scales)
    : plant_(plant), data_(data), view_(view), base_(base), scales_(scales), entries_{BentEntry()} {}

void BentLaw::FitThem() {
  constexpr std::size_t kMostFitted = 4;  // of different action
  fitted_.emplace();
  const DataScales scales = WithRanges(scales_, FeaturesOf(*base_.model, base_.fit.theta), view_.active_rows);
  std::vector<std::string> notes;  // what does not fit a limit is no rival
  std::vector<Candidate> all = Candidates(plant_->description(), entries_, scales, &notes);
  std::erase_if(all, [&](const Candidate& candidate) {
    return IsExplained(plant_->description(), candidate.binding.symbols.at("x"));
  });
  for (Candidate& candidate : BestByOneStep(std::move(all), kMostFitted, plant_, data_, base_))
    fitted_->push_back({std::move(candidate), {}, false, 0.0, {}, {}, 0.0, 0.0, false, false, false});
  support::InParallel(fitted_->size(), [&](std::size_t i) {
    Contender& c = (*fitted_)[i];
    try {
      Eigen::VectorXd theta = identify::TrajectoryModel(c.candidate.plant, data_.series).Start();
      theta.head(base_.fit.theta.size()) = base_.fit.theta;
      c.trial = Refine(c.candidate.plant, data_, theta);
      c.refined = c.trial.fit.valid;
    } catch (const PlantError&) {  // beyond the limits of a plant
    }
  });
}

std::optional<Rival> BentLaw::RivalOf(const Contender& c) {
  if (!RespondsToNothing(c.candidate)) return std::nullopt;
  if (!fitted_) FitThem();
  for (Contender& bent : *fitted_) {
    if (!bent.refined) continue;
    if (!bent.trial.judged) {
      LeaveOut(view_, &bent.trial);
      bent.alone = Compare(view_, bent, base_, false);
    }
    if (bent.alone.folds <= kExplainsIt * c.alone.folds) {
      const std::map<std::string, std::string>& symbols = bent.candidate.binding.symbols;
      return Rival{symbols.at("p") + " varied with " + symbols.at("x"), "explains as much"};
    }
  }
  return std::nullopt;
}

}  // namespace armcmc::ladder
