#include "reselect.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "bootstrap.hpp"
#include "comparison.hpp"
#include "naming.hpp"
#include "rung.hpp"

namespace armcmc::ladder {
namespace {

/// A named effect, and the values of its parameters in the model with all of them.
struct Named {
  Candidate effect;
  Eigen::VectorXd values;
};

Named WithValues(const Candidate& effect, const Eigen::VectorXd& theta) {
  return {effect, theta.segment(static_cast<Eigen::Index>(effect.first_fitted()),
                                static_cast<Eigen::Index>(effect.form().parameters.size()))};
}

Eigen::VectorXd Joined(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  Eigen::VectorXd both(a.size() + b.size());
  both << a, b;
  return both;
}

/// The model with effects added one after the other, fitted; empty if there is no room for one of them.
struct Model {
  std::shared_ptr<const Plant> plant;
  Trial trial;
  std::vector<Candidate> effects;
};

std::optional<Model> Composed(const Again& again, const Trial& base, const Eigen::VectorXd& own,
                              const std::vector<Named>& effects) {
  Model model;
  model.plant = std::make_shared<const Plant>(base.model->plant().description());
  Eigen::VectorXd theta = own;
  for (const Named& named : effects) {
    const PlantDescription& plant = model.plant->description();
    std::optional<Candidate> same = SameOn(plant, named.effect, ScalesOf(again.data, plant, again.floor));
    if (!same) return std::nullopt;
    theta = Joined(theta, named.values);
    model.plant = same->plant;
    model.effects.push_back(std::move(*same));
  }
  model.trial = Refine(model.plant, again.data, theta);
  if (!model.trial.fit.valid) return std::nullopt;
  return model;
}

/// The candidates of a rung above a model, tried and judged.
/// @param better  Whether to look for a better fit of the model first.
Rung Tried(const Again& again, const std::shared_ptr<const std::vector<EffectEntry>>& entries,
           const std::set<std::string>& families, bool better, Model* model) {
  for (;; better = false) {
    const DataScales scales = ScalesOf(again.data, model->plant->description(), again.floor);
    Rung rung;
    rung.view = MakeView(again.data, *model->trial.model, model->trial.fit.theta, scales.period);
    LeaveOut(rung.view, &model->trial);
    rung.base = model->trial;
    std::vector<std::string> notes;  // of effects that do not fit: known from the first time
    AddCandidates(*entries, scales, &rung, &notes);
    TryAll(model->plant, again.data, rung.view, again.floor, &rung, &notes);
    if (better)
      if (Trial fit = BetterBase(model->plant, again.data, rung); fit.fit.valid) {
        model->trial = std::move(fit);
        continue;
      }
    Bootstrap(&rung);
    Judge(rung.view, again.floor, families, 1.0, &rung);
    Sort(&rung);
    return rung;
  }
}

Contender* Find(const Candidate& effect, Rung* rung) {
  const auto found = std::find_if(rung->contenders.begin(), rung->contenders.end(),
                                  [&](const Contender& c) { return SamePlace(c.candidate, effect); });
  return found == rung->contenders.end() ? nullptr : &*found;
}

/// Judges a contender that was too far behind to be judged, and fits it from values that are known.
void JudgeOne(const Again& again, const Named& known, const Rung& rung, Contender* c) {
  Trial trial = Refine(c->candidate.plant, again.data, Joined(rung.base.fit.theta, known.values));
  if (trial.fit.valid && !(c->refined && c->trial.fit.cost <= trial.fit.cost)) c->trial = std::move(trial);
  if (!c->trial.fit.valid) return;
  c->refined = true;
  c->closed = std::clamp(1.0 - std::pow(c->trial.fit.error_sd / rung.base.fit.error_sd, 2), 0.0, 1.0);
  LeaveOut(rung.view, &c->trial);
  c->alone = Compare(rung.view, *c, rung.base, false);
  c->with_flexible = Compare(rung.view, *c, rung.base, true);
}

std::set<std::string> FamiliesOf(const std::vector<Candidate>& effects) {
  std::set<std::string> families;
  for (const Candidate& effect : effects) families.insert(effect.entry->family);
  return families;
}

/// Rungs above a model that name the given effects, the one that explains most first. What explains too little beside
/// the others is left out. Empty if one of them cannot be fitted.
/// @param tie  Named together on a rung of their own, the last; may be empty.
std::vector<Rung> RungsOf(const Again& again, const Ladder& ladder, Model model, std::vector<Named> effects,
                          const std::vector<Candidate>& tie) {
  std::vector<Rung> rungs;
  std::vector<Candidate> before = model.effects;
  while (!effects.empty()) {
    Rung rung = Tried(again, ladder.entries, FamiliesOf(before), false, &model);
    std::size_t first = SIZE_MAX;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < effects.size(); ++k) {
      Contender* c = Find(effects[k].effect, &rung);
      if (c == nullptr) return {};
      JudgeOne(again, effects[k], rung, c);
      if (!c->trial.judged) return {};
      if (c->alone.folds < least) {
        least = c->alone.folds;
        first = k;
      }
    }
    if (first == SIZE_MAX) return {};
    if (effects.size() == 1 && tie.empty() && !(least < 1.0 - kLeastGain)) return rungs;
    Bootstrap(&rung);
    Judge(rung.view, again.floor, FamiliesOf(before), 1.0, &rung);
    Sort(&rung);
    const Contender* leader = Find(effects[first].effect, &rung);
    NameAs({static_cast<std::size_t>(leader - rung.contenders.data())}, &rung);
    model.plant = leader->candidate.plant;
    model.trial = leader->trial;
    before.push_back(leader->candidate);
    effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(first));
    rungs.push_back(std::move(rung));
  }
  if (tie.empty()) return rungs;
  Rung rung = Tried(again, ladder.entries, FamiliesOf(before), false, &model);
  std::vector<std::size_t> named;
  for (const Candidate& effect : tie) {
    const Contender* c = Find(effect, &rung);
    if (c == nullptr || !c->trial.judged) return {};
    named.push_back(static_cast<std::size_t>(c - rung.contenders.data()));
  }
  NameAs(std::move(named), &rung);
  rungs.push_back(std::move(rung));
  return rungs;
}

/// What a rung names: one effect, or several that the data do not separate.
using Place = std::vector<Named>;

/// Whether what a rung names is to be named in the place of an effect.
bool TakesThePlace(const Contender& leader, const Contender& effect) {
  if (!effect.earned || effect.ruled_out) return true;
  const bool simpler = NumFormulaParameters(leader.candidate.form()) < NumFormulaParameters(effect.candidate.form()) &&
                       1.0 - leader.alone.folds >= kAsGood * (1.0 - effect.alone.folds);
  return simpler || (kFarBetter * leader.alone.folds < effect.alone.folds && BetterEverywhere(leader, effect));
}

std::string NamesOf(const std::vector<Candidate>& effects, const std::string& last) {
  std::string text;
  for (std::size_t k = 0; k < effects.size(); ++k) {
    if (k > 0) text += k + 1 < effects.size() ? ", " : last;
    text += effects[k].entry->name;
  }
  return text;
}

std::vector<Candidate> EffectsOf(const Place& place) {
  std::vector<Candidate> effects;
  for (const Named& named : place) effects.push_back(named.effect);
  return effects;
}

/// What became of an effect that was tested again.
struct Outcome {
  bool holds = true;
  Place instead;  ///< Named in its place; may be empty.
  std::string note;
};

/// Whether one of the effects removes a tenth of the squared error that the model without them leaves.
/// @param model  Without them; its errors on left-out rows are set.
bool IsNeeded(const Again& again, const Place& place, Model* model) {
  const DataScales scales = ScalesOf(again.data, model->plant->description(), again.floor);
  Rung rung;
  rung.view = MakeView(again.data, *model->trial.model, model->trial.fit.theta, scales.period);
  LeaveOut(rung.view, &model->trial);
  rung.base = model->trial;
  return std::any_of(place.begin(), place.end(), [&](const Named& named) {
    std::optional<Candidate> same = SameOn(model->plant->description(), named.effect, scales);
    if (!same) return true;
    Contender c{std::move(*same), {}, false, 0.0, {}, {}, 0.0, 0.0, false, false, false};
    JudgeOne(again, named, rung, &c);
    return !c.trial.judged || c.alone.folds < 1.0 - kLeastGain;
  });
}

/// Whether one of the others is the same effect, in another place or with another formula.
bool IsThere(const Candidate& effect, const std::vector<Candidate>& others) {
  return std::any_of(others.begin(), others.end(), [&](const Candidate& other) { return other.entry == effect.entry; });
}

/// Whether another effect of the same family was named besides: asymmetric friction holds dry friction as a special
/// case, and is a closer description of what was rightly named before.
bool IsRefined(const Place& place, const std::vector<Candidate>& others) {
  return std::any_of(others.begin(), others.end(), [&](const Candidate& other) {
    return std::any_of(place.begin(), place.end(), [&](const Named& named) {
      const EffectEntry& entry = *named.effect.entry;
      return other.entry != &entry && other.entry->family == entry.family;
    });
  });
}

/// @param place  What was named. @param model  With what was named besides.
Outcome TestAgain(const Again& again, const Ladder& ladder, const std::vector<Candidate>& dropped, const Place& place,
                  Model model) {
  Outcome out;
  const bool several = place.size() > 1;
  const std::string then = NamesOf(EffectsOf(place), " or "), beside = NamesOf(model.effects, " and ");
  out.note = then + ", named at first, " + (several ? "are" : "is") + " not needed: beside " + beside + ", ";
  if (!IsNeeded(again, place, &model)) {
    out.holds = IsRefined(place, model.effects);
    if (IsThere(place.front().effect, model.effects))
      out.note = then + " is named once: the first of two explains nothing beside " + beside;
    else
      out.note += several ? "they explain nothing" : "it explains nothing";
    return out;
  }
  Rung rung = Tried(again, ladder.entries, FamiliesOf(model.effects), true, &model);
  const Contender* best = nullptr;  // of what was named
  for (const Named& named : place) {
    Contender* own = Find(named.effect, &rung);
    if (own != nullptr && !own->trial.judged) JudgeOne(again, named, rung, own);
    if (own == nullptr || !own->trial.judged) return out;
    if (best == nullptr || own->alone.folds < best->alone.folds) best = own;
  }
  std::vector<const Candidate*> before;
  for (const Candidate& other : model.effects) before.push_back(&other);
  const double explained = std::pow(again.start_sd / rung.base.fit.error_sd, 2) - 1.0;
  const DataScales scales = ScalesOf(again.data, model.plant->description(), again.floor);
  std::vector<std::string> notes;  // of names that are given to nothing if the effect holds
  NameAndConfirm({again.all, again.data, again.own, model.plant, scales, again.floor, nullptr, before, explained},
                 &rung, &notes);
  if (rung.named.empty()) return out;
  for (const std::size_t i : rung.named) {
    const Contender& c = rung.contenders[i];
    const auto same = [&](const Candidate& other) { return SamePlace(other, c.candidate); };
    if (std::any_of(dropped.begin(), dropped.end(), same)) return out;
    out.instead.push_back(WithValues(c.candidate, c.trial.fit.theta));
  }
  const auto known = [&](const Named& now) {
    return std::any_of(place.begin(), place.end(),
                       [&](const Named& old) { return old.effect.entry == now.effect.entry; });
  };
  const auto of_them = std::count_if(out.instead.begin(), out.instead.end(), known);
  // An effect that is found again holds, in whatever formula; so does a tie that is one still.
  if (several ? rung.named.size() > 1 : of_them > 0 && rung.named.size() == 1) return out;
  if (of_them == 0 && !IsThere(place.front().effect, model.effects) && !TakesThePlace(rung.leader(), *best)) return out;
  out.holds = false;
  const std::string now = NamesOf(EffectsOf(out.instead), " and ");
  if (rung.named.size() > 1)
    out.note = then + ", named at first: beside " + beside + ", the data do not separate " + now;
  else if (of_them > 0)
    out.note = then + ", not separated at first: beside " + beside + ", the data show " + now;
  else
    out.note += now + " explains the data";
  return out;
}

/// What the rungs name, with its parameters in the model with all of them.
std::vector<Place> PlacesOf(const Ladder& ladder, const Trial& full) {
  std::vector<Place> places;
  for (const Rung& rung : ladder.rungs) {
    if (rung.named.empty()) continue;
    places.emplace_back();
    for (const std::size_t i : rung.named) {
      const Contender& c = rung.contenders[i];
      places.back().push_back(WithValues(c.candidate, i == rung.named.front() ? full.fit.theta : c.trial.fit.theta));
    }
  }
  return places;
}

}  // namespace

bool Reselect(const Again& again, const Trial& full, std::vector<Candidate>* dropped, Ladder* ladder) {
  const std::vector<Place> places = PlacesOf(*ladder, full);
  const auto tie = std::find_if(places.begin(), places.end(), [](const Place& p) { return p.size() > 1; });
  for (std::size_t k = 0; k + 1 < places.size(); ++k) {
    // What is named beside a tie was tested with each of its effects.
    if (tie != places.end() && tie != places.begin() + static_cast<std::ptrdiff_t>(k)) continue;
    const Trial& base = ladder->rungs.front().base;
    const Eigen::VectorXd own = full.fit.theta.head(base.fit.theta.size());
    std::vector<Named> below, above;
    for (std::size_t other = 0; other < places.size(); ++other)
      if (other != k) (other < k ? below : above).push_back(places[other].front());
    std::vector<Named> others = below;
    others.insert(others.end(), above.begin(), above.end());
    std::optional<Model> model = Composed(again, base, own, others), under = Composed(again, base, own, below);
    if (!model || !under) continue;
    Outcome outcome = TestAgain(again, *ladder, *dropped, places[k], std::move(*model));
    if (outcome.holds) continue;
    const bool one = outcome.instead.size() == 1;
    if (one) above.push_back(outcome.instead.front());
    std::vector<Rung> made = RungsOf(again, *ladder, std::move(*under), std::move(above),
                                     one ? std::vector<Candidate>{} : EffectsOf(outcome.instead));
    if (made.empty()) continue;
    for (const Named& named : places[k])
      if (std::none_of(outcome.instead.begin(), outcome.instead.end(),
                       [&](const Named& now) { return SamePlace(now.effect, named.effect); }))
        dropped->push_back(named.effect);
    ladder->notes.push_back(outcome.note);
    ladder->rungs.resize(k);
    for (Rung& rung : made) ladder->rungs.push_back(std::move(rung));
    return true;
  }
  return false;
}

}  // namespace armcmc::ladder
