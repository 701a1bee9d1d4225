#include "bent_law.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "action.hpp"
#include "armcmc/ladder/features.hpp"
#include "fitted_rivals.hpp"
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

void BentLaw::FitRivals() {
  constexpr std::size_t kMostFitted = 4;  // of different action
  const DataScales scales = WithRanges(scales_, FeaturesOf(*base_.model, base_.fit.theta), view_.active_rows);
  std::vector<std::string> notes;  // what does not fit a limit is no rival
  std::vector<Candidate> all = Candidates(plant_->description(), entries_, scales, &notes);
  std::erase_if(all, [&](const Candidate& candidate) {
    return IsExplained(plant_->description(), candidate.binding.symbols.at("x"));
  });
  fitted_ = FittedRivals(BestByOneStep(std::move(all), kMostFitted, plant_, data_, base_), data_, base_);
}

std::optional<Rival> BentLaw::RivalOf(const Contender& c) {
  if (!IsIndependentOfSignals(c.candidate)) return std::nullopt;
  if (!fitted_) FitRivals();
  const Contender* const bent = FirstThatExplainsAsMuch(&*fitted_, view_, base_, c);
  if (bent == nullptr) return std::nullopt;
  const std::map<std::string, std::string>& symbols = bent->candidate.binding.symbols;
  return Rival{symbols.at("p") + " varied with " + symbols.at("x"), "explains as much"};
}

}  // namespace armcmc::ladder
