// Single effects beside an error of the law that every hypothesis has.

#include <algorithm>
#include <string>
#include <vector>

#include "armcmc/gap/search.hpp"

namespace armcmc::gap {
namespace {

constexpr std::size_t kBesideLaw = 6;  // effects that are fitted, most promising first

}  // namespace

Finding Search::BesideLawError() const {
  Finding finding;
  finding.verdict = Verdict::kUnnamed;
  finding.p_none = 0.0;
  finding.p_missing = finding.p_unnamed = 1.0;
  finding.base = finding.best = base_;
  std::vector<Term> terms;
  for (const EffectForm& form : *catalogue_)
    if (!form.regular && (form.exact() || !form.listed)) terms.push_back({&form, {}});
  Candidates effects = AddEach(base_, MostPromising(base_, terms, kBesideLaw));
  SortByScore(&effects);
  // At such a bound the formula is that of another effect.
  std::erase_if(effects, [](const CandidatePtr& effect) { return effect->fit.on_edge(); });
  if (effects.empty()) return finding;
  const std::string what = base_->fit.hypothesis.terms.back().form->effect;
  for (const CandidatePtr& effect : effects)
    effect->correction = std::make_shared<FlexibleCorrection>(FlexibleCorrection{what, base_->fit, effect->fit});

  finding.tried = effects;
  finding.best = effects.front();
  finding.gap = Gain(finding.best);
  if (!(finding.gap > limits_.min_gain)) return finding;
  for (const CandidatePtr& kin : Near(effects, finding.gap))
    if (kin->exact() && kin->families() == finding.best->families() && StandsOut(kin, effects))
      finding.set.push_back(kin);
  if (finding.set.empty()) return finding;
  finding.verdict = finding.set.size() == 1 ? Verdict::kNamed : Verdict::kAmbiguous;
  finding.p_unnamed = 1.0 - Closure(finding.best);
  AssignProbabilities(&finding);
  WithdrawImprobable(&finding);
  RemoveCorrections(&finding);
  Hypothesis plain = base_->fit.hypothesis;
  const Eigen::Index size = plain.terms.back().form->size();
  plain.terms.pop_back();
  finding.base = std::make_shared<Candidate>();
  finding.base->num_known = plain.terms.size();
  finding.base->fit = fitter_->Fit(plain, base_->fit.theta.head(base_->fit.theta.size() - size));
  return finding;
}

}  // namespace armcmc::gap
