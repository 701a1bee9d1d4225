// Flexible corrections: a model error of the law, or unnamed physics, that is fitted together with an effect. A
// correction is never reported, and removed before the result is written.

#include <algorithm>

#include "armcmc/gap/search.hpp"

namespace armcmc::gap {
namespace {

constexpr double kHeld = 1e9;  // precision of coordinates that stay where they are, times the noise variance
constexpr std::size_t kWithCorrection = 6;  // effects that are fitted with a correction, most promising first

}  // namespace

Search::Candidates Search::WithCorrection(const Candidates& listed, const Candidates& unlisted) const {
  std::vector<Term> corrections;
  for (const CandidatePtr& physics : unlisted) corrections.push_back(physics->fit.hypothesis.terms.back());
  for (const EffectForm& form : *catalogue_)
    if (form.regular) corrections.push_back({&form, {}});
  const Candidates with_correction = AddEach(listed.front(), corrections);
  const Term* best = nullptr;
  double most = listed.front()->fit.score();
  for (std::size_t i = 0; i < corrections.size(); ++i) {
    if (!(with_correction[i]->fit.score() > most)) continue;
    best = &corrections[i];
    most = with_correction[i]->fit.score();
  }
  if (best == nullptr) return {};
  const CandidatePtr parent = Make(fitter_->Add(base_->fit, *best));
  ++parent->num_known;
  parent->correction = std::make_shared<FlexibleCorrection>();
  parent->correction->what = best->form->effect;
  parent->correction->without = parent->fit;
  std::vector<Term> terms;
  for (const EffectForm& form : *catalogue_)
    if (form.exact()) terms.push_back({&form, {}});
  Candidates corrected = AddEach(parent, MostPromising(parent, terms, kWithCorrection));
  SortByScore(&corrected);
  return corrected;
}

bool Search::StandsOut(const CandidatePtr& candidate, const Candidates& corrected) const {
  if (!candidate->correction || candidate->fit.on_edge() || Closure(candidate) < limits_.corrected_closure)
    return false;
  const auto beyond = [](const CandidatePtr& c) { return c->fit.score() - c->correction->without.score(); };
  return std::all_of(corrected.begin(), corrected.end(), [&](const CandidatePtr& rival) {
    return rival->families() == candidate->families() ||
           (beyond(rival) < limits_.corrected_lead * beyond(candidate) && Better(candidate->fit, rival->fit));
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
  // A correction that stands in for a second effect is not needed if that effect explains more.
  const Candidates all = *good;
  std::erase_if(*good, [&](const CandidatePtr& with_correction) {
    return with_correction->correction && std::any_of(all.begin(), all.end(), [&](const CandidatePtr& c) {
             return !c->correction && holds(c, with_correction) && Better(c->fit, with_correction->fit);
           });
  });
  // If other physics does as well with the same correction, the gain is due to the correction.
  const bool sure = std::all_of(good->begin(), good->end(), [&](const CandidatePtr& with_correction) {
    return !with_correction->correction ||
           std::all_of(good->begin(), good->end(), [&](const CandidatePtr& c) { return holds(c, with_correction); });
  });
  if (!sure) std::erase_if(*good, [](const CandidatePtr& c) { return c->correction != nullptr; });
}

void Search::RemoveCorrections(Finding* finding) const {
  constexpr double kWorthTelling = 0.01;
  const auto reported = [&](const CandidatePtr& c) {
    return c == finding->best || c->probability >= kWorthTelling ||
           std::find(finding->set.begin(), finding->set.end(), c) != finding->set.end();
  };
  std::erase_if(finding->tried, [&](const CandidatePtr& c) { return c->correction && !reported(c); });
  for (const CandidatePtr& candidate : finding->tried) {
    if (!candidate->correction) continue;
    // Coordinates: base, what the model had before, the correction, the effects.
    const Fitted& with = candidate->correction->with;
    const auto& terms = with.hypothesis.terms;
    const std::size_t correction = candidate->num_known - 1;
    Eigen::Index after = 0;
    for (std::size_t i = correction + 1; i < terms.size(); ++i) after += terms[i].form->size();
    const Eigen::Index before = with.theta.size() - after - terms[correction].form->size();
    Vector start(before + after);
    start << with.theta.head(before), with.theta.tail(after);
    Hypothesis plain = with.hypothesis;
    plain.terms.erase(plain.terms.begin() + static_cast<std::ptrdiff_t>(correction));
    if (law_errs_) {
      // Refitted, the effects would make up for the law.
      CoordinatePrior held{start, Matrix::Zero(start.size(), start.size())};
      held.precision.diagonal().tail(after).setConstant(kHeld / fitter_->whitener().variance);
      candidate->fit = fitter_->Fit(plain, start, Fitter::kMaxSteps, &held);
    } else {
      candidate->fit = fitter_->Fit(plain, start);
    }
    candidate->num_known = correction;
  }
  // Without it, some formulas are at the bound at which they are another effect's.
  const auto other_effect = [](const CandidatePtr& c) { return c->correction && c->fit.on_edge(); };
  if (std::any_of(finding->set.begin(), finding->set.end(), other_effect)) Withdraw(1.0 - limits_.doubt, finding);
  if (finding->set.empty() || !finding->best->correction) return;
  finding->approximate = true;
  finding->remainder = std::max(2.0 * adequacy_check_->Judge(finding->best->fit).total() / rows_, 0.0);
}

}  // namespace armcmc::gap
