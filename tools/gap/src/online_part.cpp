#include "armcmc/gap/online_part.hpp"

#include <algorithm>

namespace armcmc::gap {
namespace {

/// Terms of the verdict: the best ones of the carrier, and those named in the other equations.
std::vector<Term> Found(const PlantDiagnosis& plant) {
  std::vector<Term> found = plant.carrying().diagnosis.finding.best->added();
  for (const EquationDiagnosis* other : plant.Others()) {
    if (other->diagnosis.finding.verdict != Verdict::kNamed) continue;
    for (const Term& term : other->diagnosis.finding.best->added()) found.push_back(term);
  }
  return found;
}

const EffectForm* OwnFormula(const EquationDiagnosis& one, const std::string& effect) {
  for (const EffectForm& form : one.diagnosis.wide->catalogue)
    if (form.exact() && form.effect == effect) return &form;
  return nullptr;
}

}  // namespace

OnlinePart OnlinePartOf(const PlantDiagnosis& plant) {
  OnlinePart part;
  const auto online = std::find_if(plant.equations.begin(), plant.equations.end(), [](const EquationDiagnosis& one) {
    return one.equation->online() && one.suitability.can_name;
  });
  const std::vector<Term> found = Found(plant);
  if (online != plant.equations.end()) {
    // The fit of the search is used if it is of this equation and needs no change.
    const CandidatePtr& best = plant.carrying().diagnosis.finding.best;
    const bool as_it_is = &*online == &plant.carrying() && best->exact() && best->added().size() == found.size();
    part.fit = as_it_is ? best->fit : online->diagnosis.finding.base->fit;
    for (const Term& term : found) {
      const EffectForm* form = OwnFormula(*online, term.form->effect);
      if (form == nullptr) {
        part.left_out.push_back(term.form->effect);
        continue;
      }
      part.equation = &*online;
      part.other_formula = part.other_formula || !term.form->variant.empty();
      if (!as_it_is) part.fit = online->diagnosis.wide->fitter->Add(part.fit, {form, term.when});
    }
  } else {
    for (const Term& term : found) part.left_out.push_back(term.form->effect);
  }
  return part;
}

}  // namespace armcmc::gap
