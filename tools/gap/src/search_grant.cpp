// Grants: a model error of the law, or unnamed physics, that is fitted together with an effect. A grant is never
// reported, and removed before the result is written.

#include <algorithm>
#include <utility>

#include "armcmc/gap/search.hpp"
#include "armcmc/support/parallel.hpp"

namespace armcmc::gap {
namespace {

constexpr std::size_t kWithCorrection = 6;  // effects that are fitted with a grant, most promising first

}  // namespace

Search::Candidates Search::WithCorrection(const Candidates& listed, const Candidates& unlisted) const {
  std::vector<Term> grants;
  for (const CandidatePtr& physics : unlisted) grants.push_back(physics->fit.hypothesis.terms.back());
  for (const EffectForm& form : *catalogue_)
    if (form.regular) grants.push_back({&form, {}});
  const Candidates granted = AddEach(listed.front(), grants);
  const Term* best = nullptr;
  double most = listed.front()->fit.score();
  for (std::size_t i = 0; i < grants.size(); ++i) {
    if (!(granted[i]->fit.score() > most)) continue;
    best = &grants[i];
    most = granted[i]->fit.score();
  }
  if (best == nullptr) return {};
  const CandidatePtr parent = Make(fitter_->Add(base_->fit, *best));
  ++parent->num_known;
  parent->granted = std::make_shared<Granted>();
  parent->granted->what = best->form->effect;
  parent->granted->without = parent->fit;
  std::vector<std::pair<double, Term>> promises;
  for (const EffectForm& form : *catalogue_)
    if (form.exact()) promises.emplace_back(0.0, Term{&form, {}});
  (void)parent->fit.basis();
  support::InParallel(promises.size(),
                      [&](std::size_t i) { promises[i].first = fitter_->Promise(parent->fit, promises[i].second); });
  std::stable_sort(promises.begin(), promises.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Term> terms;
  for (std::size_t i = 0; i < std::min(kWithCorrection, promises.size()); ++i) terms.push_back(promises[i].second);
  Candidates corrected = AddEach(parent, terms);
  SortByScore(&corrected);
  return corrected;
}

bool Search::StandsOut(const CandidatePtr& candidate, const Candidates& corrected) const {
  if (!candidate->granted || candidate->fit.on_edge() || Closure(candidate) < limits_.granted_closure) return false;
  const auto beyond = [](const CandidatePtr& c) { return c->fit.score() - c->granted->without.score(); };
  return std::all_of(corrected.begin(), corrected.end(), [&](const CandidatePtr& rival) {
    return rival->families() == candidate->families() ||
           (beyond(rival) < limits_.granted_lead * beyond(candidate) && Better(candidate->fit, rival->fit));
  });
}

CandidatePtr Search::LawError() const {
  for (const EffectForm& form : *catalogue_)
    if (form.regular) return Make(fitter_->Add(base_->fit, {&form, {}}));
  return nullptr;
}

void Search::DropUncertain(Candidates* good) const {
  const auto holds = [](const CandidatePtr& all, const CandidatePtr& some) {
    const std::vector<std::string> families = all->families(), asked = some->families();
    return std::includes(families.begin(), families.end(), asked.begin(), asked.end());
  };
  // A grant that stands in for a second effect is not needed if that effect explains more.
  const Candidates all = *good;
  std::erase_if(*good, [&](const CandidatePtr& granted) {
    return granted->granted && std::any_of(all.begin(), all.end(), [&](const CandidatePtr& c) {
             return !c->granted && holds(c, granted) && Better(c->fit, granted->fit);
           });
  });
  // If other physics does as well with the same grant, the gain is due to the grant.
  const bool sure = std::all_of(good->begin(), good->end(), [&](const CandidatePtr& granted) {
    return !granted->granted ||
           std::all_of(good->begin(), good->end(), [&](const CandidatePtr& c) { return holds(c, granted); });
  });
  if (!sure) std::erase_if(*good, [](const CandidatePtr& c) { return c->granted != nullptr; });
}

void Search::TakeBack(Finding* finding) const {
  constexpr double kWorthTelling = 0.01;
  const auto reported = [&](const CandidatePtr& c) {
    return c == finding->best || c->probability >= kWorthTelling ||
           std::find(finding->set.begin(), finding->set.end(), c) != finding->set.end();
  };
  std::erase_if(finding->tried, [&](const CandidatePtr& c) { return c->granted && !reported(c); });
  for (const CandidatePtr& candidate : finding->tried) {
    if (!candidate->granted) continue;
    // Coordinates: base, what the model had before, the grant, the effects.
    const Fitted& with = candidate->granted->with;
    const auto& terms = with.hypothesis.terms;
    const std::size_t grant = candidate->num_known - 1;
    Eigen::Index after = 0;
    for (std::size_t i = grant + 1; i < terms.size(); ++i) after += terms[i].form->size();
    const Eigen::Index before = with.theta.size() - after - terms[grant].form->size();
    Vector start(before + after);
    start << with.theta.head(before), with.theta.tail(after);
    Hypothesis plain = with.hypothesis;
    plain.terms.erase(plain.terms.begin() + static_cast<std::ptrdiff_t>(grant));
    candidate->fit = fitter_->Fit(plain, start);
    candidate->num_known = base_->num_known;
  }
  // Without it, some formulas are at the bound at which they are another effect's.
  const auto other_effect = [](const CandidatePtr& c) { return c->granted && c->fit.on_edge(); };
  if (std::any_of(finding->set.begin(), finding->set.end(), other_effect)) Withdraw(1.0 - limits_.doubt, finding);
  if (finding->set.empty() || !finding->best->granted) return;
  finding->approximate = true;
  finding->remainder = std::max(2.0 * referee_->Judge(finding->best->fit).total() / rows_, 0.0);
}

}  // namespace armcmc::gap
