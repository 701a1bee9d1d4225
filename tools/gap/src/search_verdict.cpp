// From the scores of a search to a verdict: formulas, few events, unnamed rivals, probabilities, doubt.

#include <algorithm>
#include <cmath>
#include <utility>

#include "armcmc/gap/search.hpp"

namespace armcmc::gap {

std::set<std::vector<std::string>> NamesOf(const Finding& finding) {
  std::set<std::vector<std::string>> names;
  for (const CandidatePtr& candidate : finding.set) names.insert(candidate->names());
  return names;
}

void Search::PreferCatalogue(Candidates* good) {
  // Variants are not needed if the catalogue's main formula is sufficient. An effect with fitted times is no simpler
  // than another formula that always acts; nor is one that needs a correction.
  const auto exact = [](const CandidatePtr& c) { return c->exact() && !c->correction; };
  const auto simple = [&](const CandidatePtr& c) { return exact(c) && c->always(); };
  if (std::none_of(good->begin(), good->end(), exact)) return;
  const bool all = std::any_of(good->begin(), good->end(), simple);
  std::erase_if(*good, [&](const CandidatePtr& c) { return !c->exact() && (all || !c->always()); });
}

bool Search::IsBeatenBy(const CandidatePtr& named, const CandidatePtr& unlisted) const {
  // Unnamed physics that does as well alone is simpler than a correction with an effect, as it is simpler than two
  // effects.
  if (named->added().size() > 1 || named->correction) return !Better(named->fit, unlisted->fit);
  const Vector lead = unlisted->fit.heldout - named->fit.heldout;
  return lead.sum() > limits_.tie_nats && bootstrap_->ProbabilityAbove(lead, 0.0) > limits_.p_outdone;
}

bool Search::FamilyHolds(const CandidatePtr& best, const Candidates& singles) const {
  const std::string family = best->families().front();
  return std::all_of(singles.begin(), singles.end(), [&](const CandidatePtr& rival) {
    return rival->families().front() == family || Gain(rival) < limits_.family_lead * Gain(best);
  });
}

void Search::JudgeEvents(const Candidates& singles, Finding* finding) const {
  const Vector energy = BlockSquares(base_->fit.whitened_residual);
  const auto median_of = [](Vector values) {
    std::nth_element(values.data(), values.data() + kNumBlocks / 2, values.data() + kNumBlocks);
    return values[kNumBlocks / 2];
  };
  const double median = median_of(energy);
  const double spread = 1.4826 * median_of((energy.array() - median).abs().matrix()) + 1e-300;
  const auto edges = BlockEdges(base_->fit.whitened_residual.size());
  std::vector<Eigen::Index> events;
  for (Eigen::Index b = 0; b < kNumBlocks; ++b)
    if (energy[b] > median + limits_.event_excess * spread) events.push_back(b);
  if (events.empty()) return;

  Candidates pool = singles;
  for (const CandidatePtr& gated : ExtendGated(base_, singles, 1)) pool.push_back(gated);
  const auto evidence = [&](const CandidatePtr& c) { return c->fit.log_evidence - base_->fit.log_evidence; };
  std::stable_sort(pool.begin(), pool.end(), [&](const auto& a, const auto& b) { return evidence(a) > evidence(b); });
  const auto quiet = [&](const CandidatePtr& c) {
    const Vector left = BlockSquares(c->fit.whitened_residual);
    return std::all_of(events.begin(), events.end(),
                       [&](Eigen::Index b) { return left[b] < median + limits_.event_rest * spread; });
  };
  const double margin = std::max(limits_.tie_nats, limits_.tie_share * evidence(pool.front()));
  Candidates good;
  if (evidence(pool.front()) > limits_.event_nats && pool.front()->fit.hypothesis.terms.back().form->listed)
    for (const CandidatePtr& c : pool)
      if (c->exact() && evidence(pool.front()) - evidence(c) < margin && quiet(c)) good.push_back(c);
  if (good.empty()) {
    for (const Eigen::Index b : events)
      finding->events_s.push_back(fitter_->signals().t[edges[static_cast<std::size_t>(b)]]);
    return;
  }
  finding->set = OnePerName(good);
  finding->verdict = finding->set.size() == 1 ? Verdict::kNamed : Verdict::kAmbiguous;
  finding->best = finding->set.front();
  finding->gap = 2.0 * evidence(finding->best) / rows_;
  finding->p_missing = 1.0;
  for (const CandidatePtr& c : finding->tried) c->probability = 0.0;
  for (const CandidatePtr& c : finding->set)
    if (std::find(finding->tried.begin(), finding->tried.end(), c) == finding->tried.end()) finding->tried.push_back(c);
  double total = 0.0;
  for (const CandidatePtr& c : finding->set) total += std::exp(evidence(c) - evidence(finding->best));
  for (const CandidatePtr& c : finding->set) c->probability = std::exp(evidence(c) - evidence(finding->best)) / total;
}

void Search::CheckUnexplainedEvents(const Candidates& singles, Finding* finding) const {
  if (finding->p_none > limits_.clear_nothing) return;
  finding->verdict = Verdict::kUnnamed;
  finding->best = *std::max_element(singles.begin(), singles.end(),
                                    [](const auto& a, const auto& b) { return a->probability < b->probability; });
  finding->p_missing = 1.0 - finding->p_none;
  // Every effect of the catalogue was tried on these events, and none explains them.
  finding->p_unnamed = 1.0;
  for (const CandidatePtr& candidate : finding->tried) candidate->probability = 0.0;
  (void)Judge(finding->best);
}

void Search::WidenOrWithdraw(Finding* finding) const {
  double sum = finding->best->probability;
  if (sum >= limits_.sure) return;
  Candidates others = OnePerName(finding->tried);
  std::stable_sort(others.begin(), others.end(),
                   [](const auto& a, const auto& b) { return a->probability > b->probability; });
  for (const CandidatePtr& other : others) {
    if (sum >= limits_.sure_set || finding->set.size() >= 3) break;
    const bool mine = other->names() == finding->best->names();
    if (mine || !other->exact() || other->probability < 0.05 || !Adequate(other, finding->gap) ||
        Gain(other) < limits_.adequate_closure * Gain(finding->best))
      continue;
    finding->set.push_back(other);
    sum += other->probability;
  }
  if (finding->set.size() > 1) finding->verdict = Verdict::kAmbiguous;
  WithdrawImprobable(finding);
}

void Search::WithdrawImprobable(Finding* finding) const {
  double sum = 0.0;
  for (const CandidatePtr& member : finding->set) sum += member->probability;
  // A correction or a second effect can stand for something else: a single name that needs one must be sure.
  const bool flexible = finding->best->correction || finding->best->added().size() > 1;
  if (sum >= (flexible && finding->set.size() == 1 ? limits_.sure : limits_.doubt)) return;
  Withdraw(1.0 - limits_.doubt, finding);
}

void Withdraw(double least, Finding* finding) {
  finding->verdict = Verdict::kUnnamed;
  finding->approximate = false;
  finding->set.clear();
  if (finding->p_unnamed >= least) return;
  const double kept = (1.0 - least) / (1.0 - finding->p_unnamed);
  for (const CandidatePtr& candidate : finding->tried) candidate->probability *= kept;
  finding->p_unnamed = least;
}

void Search::AssignProbabilities(Finding* finding) const {
  // One candidate for each name; differences too small for a verdict do not affect the probabilities either.
  constexpr double kMarginOdds = 3.0;  // log odds that a margin is worth
  constexpr std::size_t kCompared = 12;
  for (const CandidatePtr& candidate : finding->tried) candidate->probability = 0.0;
  Candidates compared = finding->set, rivals = finding->tried;
  // What a correction explains by itself is not credited to an effect beside it.
  std::erase_if(rivals, [&](const CandidatePtr& rival) {
    return rival->correction && !Better(rival->fit, rival->correction->without);
  });
  for (const CandidatePtr& candidate : OnePerName(rivals)) {
    if (compared.size() >= kCompared) break;
    // At such a bound the formula is that of another effect, so it is no rival to a name that does as well. If it does
    // better, the named formula is incomplete.
    if (!finding->set.empty() && candidate->fit.on_edge() &&
        candidate->fit.score() < finding->best->fit.score() + limits_.tie_nats)
      continue;
    const auto same = [&](const CandidatePtr& other) { return other->names() == candidate->names(); };
    if (std::none_of(compared.begin(), compared.end(), same)) compared.push_back(candidate);
  }
  if (finding->approximate) {
    finding->best->probability = finding->p_missing * (1.0 - finding->p_unnamed);
    return;
  }
  Matrix scores(kNumBlocks, static_cast<Eigen::Index>(compared.size()));
  for (std::size_t i = 0; i < compared.size(); ++i)
    scores.col(static_cast<Eigen::Index>(i)) = compared[i]->fit.heldout - base_->fit.heldout;
  const Vector share = bootstrap_->SoftShare(scores, std::max(Margin(finding->gap, true) / kMarginOdds, 1.0));
  for (std::size_t i = 0; i < compared.size(); ++i)
    compared[i]->probability = finding->p_missing * (1.0 - finding->p_unnamed) * share[static_cast<Eigen::Index>(i)];
  // At its bound the formula is no longer that of the effect: what it explains has no name.
  double nameless = 0.0;
  for (const CandidatePtr& candidate : compared)
    if (candidate->fit.on_edge()) nameless += std::exchange(candidate->probability, 0.0);
  if (finding->p_missing > 0.0) finding->p_unnamed += nameless / finding->p_missing;
}

}  // namespace armcmc::gap
