// A second effect that may be an error of the law.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/gap/search.hpp"

namespace armcmc::gap {

void Search::DropSmallSecond(Finding* finding) const {
  const bool law_can_err =
      std::any_of(catalogue_->begin(), catalogue_->end(), [](const EffectForm& form) { return form.regular; });
  const Candidates pairs = finding->set;
  const auto is_pair = [](const CandidatePtr& c) { return !c->correction && c->added().size() == 2; };
  if (law_can_err || pairs.empty() || !std::all_of(pairs.begin(), pairs.end(), is_pair)) return;
  const CandidatePtr best = finding->best;
  const auto explains_most = [&](const Term& effect) {
    const std::string& name = effect.form->effect;
    const auto has_it = [&](const CandidatePtr& pair) {
      const std::vector<std::string> names = pair->names();
      return std::find(names.begin(), names.end(), name) != names.end();
    };
    return std::all_of(pairs.begin(), pairs.end(), has_it) &&
           std::any_of(finding->tried.begin(), finding->tried.end(), [&](const CandidatePtr& single) {
             return !single->correction && single->names() == std::vector<std::string>{name} &&
                    Gain(single) > limits_.family_lead * Gain(best);
           });
  };
  std::vector<Term> members = best->added();
  const auto small = std::stable_partition(members.begin(), members.end(), explains_most);
  if (small - members.begin() != 1) return;
  const CandidatePtr parent = Make(fitter_->Add(base_->fit, *small));
  ++parent->num_known;
  parent->correction = std::make_shared<FlexibleCorrection>();
  parent->correction->what = small->form->effect;
  parent->correction->without = parent->fit;
  parent->correction->listed = true;
  const CandidatePtr first = AddEach(parent, {members.front()}).front();
  for (const CandidatePtr& pair : pairs) first->probability += std::exchange(pair->probability, 0.0);
  finding->verdict = Verdict::kNamed;
  finding->best = first;
  finding->set = {first};
  finding->tried.push_back(first);
  SortByScore(&finding->tried);
}

}  // namespace armcmc::gap
