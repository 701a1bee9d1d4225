#include "armcmc/gap/search.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "armcmc/gap/features.hpp"
#include "armcmc/gap/gate_scan.hpp"
#include "armcmc/support/parallel.hpp"

namespace armcmc::gap {
namespace {

constexpr std::size_t kMaxGated = 4;  // gated hypotheses that are fitted, by what the scan bounds
constexpr std::size_t kJudged = 6;
constexpr double kUnnamedAtLeast = 0.5;  // where the verdict is that
constexpr double kLawMayFeign = 1.5;     // gap up to which a model error of the law is considered as well

bool Holds(const Fitted& fit, const std::string& effect) {
  return std::any_of(fit.hypothesis.terms.begin(), fit.hypothesis.terms.end(),
                     [&](const Term& term) { return term.form->effect == effect; });
}

}  // namespace

Search::Search(const Fitter& fitter, const std::vector<EffectForm>& catalogue, const BlockBootstrap& bootstrap,
               const Thresholds& thresholds, Fitted base)
    : fitter_(&fitter),
      catalogue_(&catalogue),
      bootstrap_(&bootstrap),
      limits_(thresholds),
      adequacy_check_(std::make_unique<AdequacyCheck>(fitter, base.predicted)),
      base_(std::make_shared<Candidate>()),
      rows_(static_cast<double>(fitter.signals().rows())) {
  base_->num_known = base.hypothesis.terms.size();
  law_errs_ = base_->num_known > 0 && base.hypothesis.terms.back().form->regular;
  base_->fit = std::move(base);
}

CandidatePtr Search::Make(Fitted fit, const CandidatePtr& parent) const {
  auto candidate = std::make_shared<Candidate>();
  candidate->fit = std::move(fit);
  candidate->num_known = parent ? parent->num_known : base_->num_known;
  if (parent && parent->correction) {
    candidate->correction = std::make_shared<FlexibleCorrection>(*parent->correction);
    candidate->correction->with = candidate->fit;
  }
  return candidate;
}

const Remainder& Search::Judge(const CandidatePtr& candidate) const {
  if (!candidate->remainder) candidate->remainder = adequacy_check_->Judge(candidate->fit);
  return *candidate->remainder;
}

double Search::Gain(const CandidatePtr& candidate) const {
  return 2.0 * (candidate->fit.score() - base_->fit.score()) / rows_;
}

double Search::Closure(const CandidatePtr& candidate) const {
  const double left = std::max(2.0 * Judge(candidate).total() / rows_, 0.0);
  return Gain(candidate) / (Gain(candidate) + left + 1e-12);
}

bool Search::Adequate(const CandidatePtr& candidate, double gap) const {
  const Remainder& left = Judge(candidate);
  if (candidate->fit.on_edge() || Closure(candidate) < limits_.adequate_closure) return false;
  const double floor = std::max(limits_.min_remainder, limits_.remainder_share * gap);
  return 2.0 * left.total() / rows_ < floor ||
         bootstrap_->ProbabilityAbove(left.gain, 0.1 * limits_.min_gain * rows_) < limits_.p_remainder;
}

bool Search::Better(const Fitted& a, const Fitted& b) const {
  const Vector difference = a.heldout - b.heldout;
  return 2.0 * difference.sum() / rows_ > limits_.min_gain &&
         bootstrap_->ProbabilityAbove(difference, 0.1 * limits_.min_gain * rows_) > limits_.p_reject;
}

double Search::Margin(double gap, bool kin) const {
  return std::max({limits_.tie_nats, 0.5 * rows_ * limits_.tie_effect * limits_.tie_effect,
                   (kin ? limits_.tie_share_kin : limits_.tie_share) * rows_ * gap / 2.0});
}

Search::Candidates Search::Near(const Candidates& sorted, double gap) const {
  Candidates near;
  for (std::size_t i = 0; i < std::min(kJudged, sorted.size()); ++i) {
    const Vector difference = sorted.front()->fit.heldout - sorted[i]->fit.heldout;
    const bool kin = sorted[i]->families() == sorted.front()->families();
    const bool needs_gate = sorted.front()->always() && !sorted[i]->always();
    const double margin = Margin(gap, kin), sure = kin || needs_gate ? limits_.p_reject_lightly : limits_.p_reject;
    if (difference.sum() < margin || bootstrap_->ProbabilityAbove(difference, margin) < sure) near.push_back(sorted[i]);
  }
  return near;
}

Search::Candidates Search::AddEach(const CandidatePtr& parent, const std::vector<Term>& terms) const {
  (void)parent->fit.basis();
  Candidates candidates(terms.size());
  support::InParallel(terms.size(),
                      [&](std::size_t i) { candidates[i] = Make(fitter_->Add(parent->fit, terms[i]), parent); });
  return candidates;
}

std::vector<Term> Search::MostPromising(const CandidatePtr& parent, const std::vector<Term>& terms,
                                        std::size_t count) const {
  std::vector<std::pair<double, Term>> ranked(terms.size());
  (void)parent->fit.basis();
  support::InParallel(terms.size(), [&](std::size_t i) {
    ranked[i] = {fitter_->LeastDecrease(parent->fit, terms[i]), terms[i]};
  });
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Term> most;
  for (std::size_t i = 0; i < std::min(count, ranked.size()); ++i) most.push_back(ranked[i].second);
  return most;
}

Search::Candidates Search::Extend(const CandidatePtr& parent, bool variants) const {
  std::vector<Term> terms;
  for (const EffectForm& form : *catalogue_)
    if (!form.regular && !Holds(parent->fit, form.effect) && (form.exact() || variants)) terms.push_back({&form, {}});
  Candidates extended = AddEach(parent, terms);
  // A second effect that acts at times only could repair the formula of the first.
  const double floor = parent == base_ ? 0.0 : limits_.tie_share * Gain(parent) * rows_ / 2.0;
  const auto better = [&](const CandidatePtr& gated) {
    const EffectForm* form = gated->fit.hypothesis.terms.back().form;
    if (gated->fit.score() - parent->fit.score() < floor) return false;
    return std::all_of(extended.begin(), extended.end(), [&](const CandidatePtr& other) {
      return other->fit.hypothesis.terms.back().form != form || Better(gated->fit, other->fit);
    });
  };
  Candidates gated = ExtendGated(parent, extended, limits_.min_active_blocks);
  std::erase_if(gated, [&](const CandidatePtr& candidate) { return !better(candidate); });
  extended.insert(extended.end(), gated.begin(), gated.end());
  SortByScore(&extended);
  return extended;
}

Search::Candidates Search::ExtendGated(const CandidatePtr& parent, const Candidates& always, int min_active) const {
  (void)parent->fit.basis();
  std::vector<std::vector<GateCandidate>> found(always.size());
  support::InParallel(always.size(), [&](std::size_t i) {
    const Fitted& single = always[i]->fit;
    const EffectForm& form = *single.hypothesis.terms.back().form;
    if (!form.exact() || !(form.gates_by_time || form.gates_by_mode)) return;
    found[i] = ScanGates(*fitter_, parent->fit, form, Templates(*fitter_, parent->fit, form, &single), min_active);
  });
  std::vector<GateCandidate> gates;
  for (std::size_t i = 0; i < always.size(); ++i)
    for (const GateCandidate& gate : found[i]) {
      const double ungated = std::max(parent->fit.squares - always[i]->fit.squares, gate.always_gain);
      if (gate.gain - ungated > limits_.min_gain * rows_ * fitter_->whitener().variance) gates.push_back(gate);
    }
  std::sort(gates.begin(), gates.end(), [](const auto& a, const auto& b) { return a.gain > b.gain; });
  if (gates.size() > kMaxGated) gates.resize(kMaxGated);
  std::vector<Term> terms;
  terms.reserve(gates.size());
  for (const GateCandidate& gate : gates) terms.push_back(gate.term);
  Candidates gated = AddEach(parent, terms);
  if (parent == base_) ShareOnset(min_active, &gated);
  return gated;
}

void Search::ShareOnset(int min_active, Candidates* gated) const {
  CandidatePtr leader;
  for (const CandidatePtr& candidate : *gated) {
    const When::Kind kind = candidate->fit.hypothesis.terms.back().when.kind;
    const bool in_time = kind == When::Kind::kFrom || kind == When::Kind::kUntil;
    if (in_time && (!leader || candidate->fit.score() > leader->fit.score())) leader = candidate;
  }
  if (!leader) return;
  const Term first = leader->fit.hypothesis.terms.back();
  const auto dated = [&](const EffectForm& form) {
    return std::any_of(gated->begin(), gated->end(), [&](const CandidatePtr& candidate) {
      const Term& term = candidate->fit.hypothesis.terms.back();
      return term.form == &form && term.when.kind == When::Kind::kFrom;
    });
  };
  std::vector<const EffectForm*> forms;
  for (const EffectForm& form : *catalogue_) {
    if (!form.exact() || !form.gates_by_time || dated(form)) continue;
    const bool misfitted = !form.linear && form.force == nullptr;
    if (misfitted || form.family == first.form->family) forms.push_back(&form);
  }
  std::vector<Candidates> found(forms.size());
  support::InParallel(forms.size(), [&](std::size_t i) {
    const EffectForm& form = *forms[i];
    // Starts from the shape of the effect with that onset.
    const Fitted shape = fitter_->Add(base_->fit, {&form, {When::Kind::kFrom, first.when.time_s}});
    for (const GateCandidate& gate :
         ScanGates(*fitter_, base_->fit, form, Templates(*fitter_, base_->fit, form, &shape), min_active))
      if (gate.term.when.kind == When::Kind::kFrom) found[i].push_back(Make(fitter_->Add(base_->fit, gate.term)));
  });
  for (const Candidates& some : found) gated->insert(gated->end(), some.begin(), some.end());
}

Search::Candidates Search::OnePerName(const Candidates& candidates) const {
  // Of the formulas of the same effects the catalogue's is reported, unless another is clearly better.
  std::map<std::vector<std::string>, CandidatePtr> best;
  std::vector<std::vector<std::string>> order;
  for (const CandidatePtr& candidate : candidates) {
    const auto names = candidate->names();
    auto [it, inserted] = best.try_emplace(names, candidate);
    if (inserted) {
      order.push_back(names);
      continue;
    }
    const bool drops_gate =
        candidate->exact() && candidate->always() && !it->second->always() && !Better(it->second->fit, candidate->fit);
    if (drops_gate || (candidate->exact() && !it->second->exact())) it->second = candidate;
  }
  Candidates result;
  for (const auto& names : order) result.push_back(best[names]);
  return result;
}

Search::Candidates Search::Listed(const Candidates& candidates, bool listed) const {
  Candidates some;
  std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(some),
               [&](const CandidatePtr& c) { return c->fit.hypothesis.terms.back().form->listed == listed; });
  return some;
}

Finding Search::Run(bool pairs) const {
  if (law_errs_) return BesideLawError();
  Finding finding;
  finding.base = finding.best = base_;
  const Vector flexible = Judge(base_).gain;
  const Candidates singles = Extend(base_, true);
  const Vector named = singles.front()->fit.heldout - base_->fit.heldout;
  // A flexible model sees what has no name, a name what no flexible model has the shape for.
  const double gap = finding.gap = std::max(2.0 * std::max(flexible.sum(), named.sum()) / rows_, 0.0);
  for (const Vector& gain : {flexible, named})
    if (2.0 * gain.sum() / rows_ > std::max(limits_.min_gain, 2.0 * limits_.min_nats / rows_))
      finding.p_missing =
          std::max(finding.p_missing, bootstrap_->ProbabilityAbove(gain, 0.1 * limits_.min_gain * rows_));
  finding.tried = singles;
  const double least = std::max(limits_.min_gain, 2.0 * limits_.min_nats / rows_);
  Candidates listed = Listed(singles, true);
  const Candidates unlisted = Listed(singles, false);
  if (!(gap > least) || finding.p_missing < limits_.p_missing) {
    finding.p_none = ProbabilityOfNone(singles);
    const double seen = bootstrap_->ProbabilityAbove(listed.front()->fit.heldout - base_->fit.heldout, 0.0);
    const bool clear = finding.p_none < limits_.clear_nothing && seen > limits_.p_missing &&
                       Ratio(listed.front()) > limits_.visible_ratio;
    if (!clear) {
      JudgeEvents(singles, &finding);
      if (finding.verdict == Verdict::kNone && !finding.events_s.empty()) CheckUnexplainedEvents(singles, &finding);
      if (finding.verdict == Verdict::kNone) AllowForLawError(&finding);
      return finding;
    }
    finding.p_missing = 1.0 - finding.p_none;
  }

  const Candidates near = Near(listed, gap);
  std::vector<char> adequate(near.size());
  support::InParallel(near.size(), [&](std::size_t i) { adequate[i] = Adequate(near[i], gap) ? 1 : 0; });
  Candidates good;
  for (std::size_t i = 0; i < near.size(); ++i)
    if (adequate[i] != 0) good.push_back(near[i]);
  CandidatePtr top = listed.front();
  Candidates all_pairs, second;
  if (!good.empty()) {
    top = good.front();
    if (pairs) {
      second = Extend(top, false);
      if (!second.empty() && Better(second.front()->fit, top->fit)) good.clear();
    }
  }
  if (good.empty() && pairs) {
    all_pairs = Pairs(listed, second.empty() ? nullptr : top, second);
    // Given the other, the gate of a member may have been found that its own scan had missed: then it may do alone.
    const Candidates alone = GatedAlone(all_pairs, listed);
    finding.tried.insert(finding.tried.end(), alone.begin(), alone.end());
    listed.insert(listed.end(), alone.begin(), alone.end());
    SortByScore(&listed);
    for (const CandidatePtr& candidate : alone)
      if (!Better(all_pairs.front()->fit, candidate->fit) && Adequate(candidate, gap)) good.push_back(candidate);
    SortByScore(&good);
  }
  Candidates corrected;
  if (good.empty() && !all_pairs.empty()) {
    corrected = WithCorrection(listed, unlisted);
    Candidates two = all_pairs;
    two.insert(two.end(), corrected.begin(), corrected.end());
    SortByScore(&two);
    for (const CandidatePtr& pair : Near(two, gap)) {
      const auto has_evidence = [&](const CandidatePtr& single) {
        return !Holds(pair->fit, single->fit.hypothesis.terms.back().form->effect) || Better(pair->fit, single->fit);
      };
      // The correction is not claimed: only the effect needs the evidence for a name.
      const bool all_earned = pair->correction ? Better(pair->fit, pair->correction->without)
                                               : std::all_of(listed.begin(), listed.end(), has_evidence);
      if (all_earned && (Adequate(pair, gap) || StandsOut(pair, corrected))) good.push_back(pair);
    }
    DropUncertain(&good);
    // The best fit gives the best estimate of the noise.
    top = good.empty() ? two.front() : good.front();
  }
  // A name is not given to what physics outside the catalogue explains better, or as well with one effect less.
  if (!unlisted.empty() && Gain(unlisted.front()) > limits_.min_gain &&
      (good.empty() || IsBeatenBy(good.front(), unlisted.front())) && Adequate(unlisted.front(), gap)) {
    good.clear();
    finding.unlisted = top = unlisted.front();
  }
  if (const CandidatePtr law = good.empty() || gap > kLawMayFeign ? nullptr : LawError();
      law && IsBeatenBy(good.front(), law) && Adequate(law, gap)) {
    good.clear();
    finding.unlisted = top = law;
  }
  finding.tried.insert(finding.tried.end(), all_pairs.begin(), all_pairs.end());
  finding.tried.insert(finding.tried.end(), corrected.begin(), corrected.end());
  if (!corrected.empty()) {
    // The correction alone is a hypothesis as well; unnamed physics has been tried among the singles.
    const Fitted& alone = corrected.front()->correction->without;
    if (alone.hypothesis.terms.back().form->regular) finding.tried.push_back(Make(alone));
  }
  SortByScore(&finding.tried);
  PreferCatalogue(&good);
  finding.set = OnePerName(good);
  if (!finding.set.empty()) {
    finding.verdict = finding.set.size() == 1 ? Verdict::kNamed : Verdict::kAmbiguous;
    finding.best = finding.set.front();
  } else {
    finding.verdict = Verdict::kUnnamed;
    finding.best = top;
    const CandidatePtr single = listed.front();
    if (!finding.unlisted && !single->fit.on_edge() && Closure(single) > limits_.family_closure &&
        FamilyHolds(single, singles)) {
      finding.verdict = Verdict::kNamed;
      finding.approximate = true;
      finding.best = single;
      finding.set = {single};
    }
  }
  finding.remainder = std::max(2.0 * Judge(finding.best).total() / rows_, 0.0);
  // An adequate hypothesis may leave the share; it would take clearly more to call for another name.
  finding.p_unnamed = bootstrap_->ProbabilityAbove(Judge(finding.best).gain,
                                                   rows_ * std::max(limits_.min_gain, limits_.remainder_share * gap));
  if (finding.approximate || finding.best->correction)
    finding.p_unnamed = std::min(finding.p_unnamed, 1.0 - Closure(finding.best));
  // No name was given because something is left, be it little.
  if (finding.verdict == Verdict::kUnnamed)
    finding.p_unnamed =
        std::max({finding.p_unnamed, kUnnamedAtLeast,
                  bootstrap_->ProbabilityAbove(Judge(finding.best).gain, 0.1 * limits_.min_gain * rows_)});
  AssignProbabilities(&finding);
  if (finding.verdict == Verdict::kNamed && !finding.approximate) WidenOrWithdraw(&finding);
  DropSmallSecond(&finding);
  if (finding.verdict == Verdict::kAmbiguous) WithdrawImprobable(&finding);
  RemoveCorrections(&finding);
  return finding;
}

}  // namespace armcmc::gap
