#include "armcmc/gap/search.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "armcmc/gap/features.hpp"
#include "armcmc/gap/gate_scan.hpp"

namespace armcmc::gap {
namespace {

constexpr int kBaseSteps = 30;
constexpr std::size_t kMaxGated = 4;      // gated hypotheses that are fitted, by what the scan promises
constexpr std::size_t kPairBeam = 4;      // singles that get partners
constexpr std::size_t kRefinedPairs = 3;  // pairs whose formulas and gates are tried anew
constexpr std::size_t kJudged = 6;

void SortByScore(std::vector<CandidatePtr>* candidates) {
  std::stable_sort(candidates->begin(), candidates->end(),
                   [](const auto& a, const auto& b) { return a->fit.score() > b->fit.score(); });
}

CandidatePtr Make(Fitted fit) {
  auto candidate = std::make_shared<Candidate>();
  candidate->fit = std::move(fit);
  return candidate;
}

bool Holds(const Fitted& fit, const std::string& effect) {
  return std::any_of(fit.hypothesis.terms.begin(), fit.hypothesis.terms.end(),
                     [&](const Term& term) { return term.form->effect == effect; });
}

bool GatedBy(const Term& term) { return term.when.kind != When::Kind::kAlways; }

}  // namespace

std::vector<std::string> Candidate::names() const {
  std::vector<std::string> names;
  for (const Term& term : fit.hypothesis.terms) names.push_back(term.form->effect);
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> Candidate::families() const {
  std::vector<std::string> families;
  for (const Term& term : fit.hypothesis.terms) families.push_back(term.form->family);
  std::sort(families.begin(), families.end());
  return families;
}

bool Candidate::exact() const {
  return std::all_of(fit.hypothesis.terms.begin(), fit.hypothesis.terms.end(),
                     [](const Term& term) { return term.form->exact(); });
}

Search::Search(const Fitter& fitter, const std::vector<EffectForm>& catalogue, const BlockBootstrap& bootstrap,
               const Thresholds& thresholds)
    : fitter_(&fitter),
      catalogue_(&catalogue),
      bootstrap_(&bootstrap),
      limits_(thresholds),
      rows_(static_cast<double>(fitter.signals().rows())) {}

const Remainder& Search::Judge(const CandidatePtr& candidate) const {
  if (!candidate->remainder) candidate->remainder = referee_->Judge(candidate->fit);
  return *candidate->remainder;
}

double Search::Gain(const CandidatePtr& candidate) const {
  return 2.0 * (candidate->fit.score() - base_->fit.score()) / rows_;
}

double Search::Closure(const CandidatePtr& candidate) const {
  const double left = std::max(2.0 * Judge(candidate).total() / rows_, 0.0);
  return Gain(candidate) / (Gain(candidate) + left + 1e-12);
}

bool Search::Adequate(const CandidatePtr& candidate) const {
  const Remainder& left = Judge(candidate);
  const double floor = std::max(limits_.min_gain, limits_.remainder_share * gap_);
  return 2.0 * left.total() / rows_ < floor ||
         bootstrap_->ProbabilityAbove(left.gain, 0.1 * limits_.min_gain * rows_) < limits_.p_remainder;
}

bool Search::Better(const Fitted& a, const Fitted& b) const {
  const Vector difference = a.heldout - b.heldout;
  return 2.0 * difference.sum() / rows_ > limits_.min_gain &&
         bootstrap_->ProbabilityAbove(difference, 0.1 * limits_.min_gain * rows_) > limits_.p_reject;
}

double Search::Margin() const {
  return std::max({limits_.tie_nats, 0.5 * rows_ * limits_.tie_effect * limits_.tie_effect,
                   limits_.tie_share * rows_ * gap_ / 2.0});
}

Search::Candidates Search::Near(const Candidates& sorted, std::size_t count) const {
  Candidates near;
  for (std::size_t i = 0; i < std::min(count, sorted.size()); ++i) {
    const Vector difference = sorted.front()->fit.heldout - sorted[i]->fit.heldout;
    if (difference.sum() < Margin() || bootstrap_->ProbabilityAbove(difference, Margin()) < limits_.p_reject)
      near.push_back(sorted[i]);
  }
  return near;
}

Search::Candidates Search::Extend(const CandidatePtr& parent, bool variants) const {
  Candidates extended;
  std::vector<GateCandidate> gates;
  std::map<const EffectForm*, CandidatePtr> always;
  for (const EffectForm& form : *catalogue_) {
    if (Holds(parent->fit, form.effect) || (!form.exact() && !variants)) continue;
    const CandidatePtr single = Make(fitter_->Add(parent->fit, {&form, {}}));
    extended.push_back(single);
    always[&form] = single;
    if (!form.exact() || !(form.gates_by_time || form.gates_by_mode)) continue;
    for (GateCandidate& gate :
         ScanGates(*fitter_, parent->fit, form, Templates(*fitter_, parent->fit, form, &single->fit),
                   limits_.min_active_blocks)) {
      // Beyond the parameters of the ungated fit, and of the look at every onset.
      const double floor = std::max(parent->fit.squares - single->fit.squares, gate.always_gain);
      if (gate.gain - floor > limits_.min_gain * rows_ * fitter_->whitener().s2) gates.push_back(gate);
    }
  }
  std::sort(gates.begin(), gates.end(), [](const auto& a, const auto& b) { return a.gain > b.gain; });
  for (std::size_t i = 0; i < std::min(gates.size(), kMaxGated); ++i) {
    const CandidatePtr gated = Make(fitter_->Add(parent->fit, gates[i].term));
    if (Better(gated->fit, always[gates[i].term.form]->fit)) extended.push_back(gated);
  }
  SortByScore(&extended);
  return extended;
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
    if (candidate->exact() && !it->second->exact()) it->second = candidate;
  }
  Candidates result;
  for (const auto& names : order) result.push_back(best[names]);
  return result;
}

CandidatePtr Search::Refined(const CandidatePtr& pair) const {
  // Each member anew, given the other: any formula of the same effect, any gate.
  CandidatePtr best = pair;
  for (std::size_t member = 0; member < pair->fit.hypothesis.terms.size(); ++member) {
    Hypothesis others;
    std::vector<double> theta(best->fit.theta.data(), best->fit.theta.data() + 0);
    const std::vector<Term> terms = best->fit.hypothesis.terms;
    int num_terms = 0;
    for (const Term& term : terms) num_terms += term.form->size();
    const auto num_base = static_cast<int>(best->fit.theta.size()) - num_terms;
    theta.assign(best->fit.theta.data(), best->fit.theta.data() + num_base);
    int at = num_base;
    for (std::size_t i = 0; i < terms.size(); ++i) {
      if (i != member) {
        others.terms.push_back(terms[i]);
        theta.insert(theta.end(), best->fit.theta.data() + at, best->fit.theta.data() + at + terms[i].form->size());
      }
      at += terms[i].form->size();
    }
    const CandidatePtr parent =
        Make(fitter_->Fit(others, Eigen::Map<Vector>(theta.data(), static_cast<Eigen::Index>(theta.size()))));
    for (const EffectForm& form : *catalogue_) {
      if (form.effect != terms[member].form->effect) continue;
      std::vector<Term> tries{{&form, {}}};
      if (form.exact())
        for (const GateCandidate& gate :
             ScanGates(*fitter_, parent->fit, form, Templates(*fitter_, parent->fit, form, nullptr),
                       limits_.min_active_blocks))
          if (gate.gain - gate.always_gain > limits_.min_gain * rows_ * fitter_->whitener().s2)
            tries.push_back(gate.term);
      for (const Term& term : tries) {
        CandidatePtr other = Make(fitter_->Add(parent->fit, term));
        const bool simpler = !GatedBy(term) && form.exact();
        const double lead = other->fit.score() - best->fit.score();
        if (simpler ? lead > 0.0 : Better(other->fit, best->fit)) best = other;
      }
    }
  }
  return best;
}

Search::Candidates Search::Pairs(const Candidates& order) const {
  Candidates pairs;
  std::set<std::vector<std::string>> beam;
  for (const CandidatePtr& first : order) {
    if (beam.size() >= kPairBeam) break;
    if (Gain(first) < limits_.min_gain || !beam.insert(first->names()).second) continue;
    for (const CandidatePtr& pair : Extend(first, false)) pairs.push_back(pair);
  }
  SortByScore(&pairs);
  pairs = OnePerName(pairs);
  for (std::size_t i = 0; i < std::min(kRefinedPairs, pairs.size()); ++i) pairs[i] = Refined(pairs[i]);
  SortByScore(&pairs);
  return pairs;
}

Search::Candidates Search::Listed(const Candidates& candidates, bool listed) const {
  Candidates some;
  std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(some),
               [&](const CandidatePtr& c) { return c->fit.hypothesis.terms.front().form->listed == listed; });
  return some;
}

bool Search::Outdone(const CandidatePtr& named, const CandidatePtr& unlisted) const {
  if (named->fit.hypothesis.terms.size() > 1) return !Better(named->fit, unlisted->fit);
  const Vector lead = unlisted->fit.heldout - named->fit.heldout;
  return lead.sum() > limits_.tie_nats && bootstrap_->ProbabilityAbove(lead, 0.0) > limits_.p_remainder;
}

bool Search::FamilyHolds(const CandidatePtr& best, const Candidates& singles) const {
  const std::string family = best->families().front();
  return std::all_of(singles.begin(), singles.end(), [&](const CandidatePtr& rival) {
    return rival->families().front() == family || Gain(rival) < limits_.family_lead * Gain(best);
  });
}

Finding Search::Run(bool pairs) {
  Finding finding;
  const Equation& equation = fitter_->equation();
  base_ = Make(fitter_->Fit({}, equation.Start(fitter_->signals()), kBaseSteps));
  finding.base = finding.best = base_;
  if (!referee_) referee_ = std::make_unique<Referee>(*fitter_, base_->fit.predicted);
  const Vector flexible = Judge(base_).gain;
  const Candidates singles = Extend(base_, true);
  const Vector named = singles.front()->fit.heldout - base_->fit.heldout;
  const Vector& gain = flexible.sum() > named.sum() ? flexible : named;
  gap_ = finding.gap = std::max(2.0 * gain.sum() / rows_, 0.0);
  finding.p_missing = bootstrap_->ProbabilityAbove(gain, 0.1 * limits_.min_gain * rows_);
  finding.tried = singles;
  if (!(gap_ > limits_.min_gain) || finding.p_missing < limits_.p_missing) return finding;

  const Candidates listed = Listed(singles, true), unlisted = Listed(singles, false);
  Candidates good;
  for (const CandidatePtr& candidate : Near(listed, kJudged))
    if (Adequate(candidate)) good.push_back(candidate);
  CandidatePtr top = listed.front();
  Candidates all_pairs;
  if (!good.empty()) {
    top = good.front();
    if (pairs) {
      const Candidates second = Extend(top, false);
      if (!second.empty() && Better(second.front()->fit, top->fit)) good.clear();
    }
  }
  if (good.empty() && pairs) {
    all_pairs = Pairs(listed);
    for (const CandidatePtr& pair : Near(all_pairs, kJudged)) {
      const bool earned = std::all_of(listed.begin(), listed.end(), [&](const CandidatePtr& single) {
        return !Holds(pair->fit, single->fit.hypothesis.terms[0].form->effect) || Better(pair->fit, single->fit);
      });
      if (earned && Adequate(pair)) good.push_back(pair);
    }
    if (!all_pairs.empty()) top = good.empty() ? all_pairs.front() : good.front();
  }
  // A name is not given to what physics outside the catalogue explains better, or as well with one effect less.
  if (!unlisted.empty() && Gain(unlisted.front()) > limits_.min_gain &&
      (good.empty() || Outdone(good.front(), unlisted.front())) && Adequate(unlisted.front())) {
    good.clear();
    finding.unlisted = top = unlisted.front();
  }
  finding.tried.insert(finding.tried.end(), all_pairs.begin(), all_pairs.end());
  SortByScore(&finding.tried);
  // Where the catalogue's own formulas do, others are not needed.
  if (std::any_of(good.begin(), good.end(), [](const CandidatePtr& c) { return c->exact(); }))
    std::erase_if(good, [](const CandidatePtr& c) { return !c->exact(); });
  finding.set = OnePerName(good);
  if (!finding.set.empty()) {
    finding.verdict = finding.set.size() == 1 ? Verdict::kNamed : Verdict::kAmbiguous;
    finding.best = finding.set.front();
  } else {
    finding.verdict = Verdict::kUnnamed;
    finding.best = top;
    const CandidatePtr single = listed.front();
    if (!finding.unlisted && Closure(single) > limits_.family_closure && FamilyHolds(single, singles)) {
      finding.verdict = Verdict::kNamed;
      finding.approximate = true;
      finding.best = single;
      finding.set = {single};
    }
  }
  finding.remainder = std::max(2.0 * Judge(finding.best).total() / rows_, 0.0);
  finding.p_unnamed = bootstrap_->ProbabilityAbove(
      Judge(finding.best).gain, 0.5 * rows_ * std::max(limits_.min_gain, limits_.remainder_share * gap_));
  if (finding.approximate) finding.p_unnamed = std::min(finding.p_unnamed, 1.0 - Closure(finding.best));
  if (finding.verdict == Verdict::kUnnamed) finding.p_unnamed = std::max(finding.p_unnamed, 0.5);
  AssignProbabilities(&finding);
  return finding;
}

void Search::AssignProbabilities(Finding* finding) const {
  // One candidate a name; differences that do not decide a verdict do not decide a probability either.
  constexpr double kMarginOdds = 3.0;  // log odds that a margin is worth
  constexpr std::size_t kCompared = 12;
  Candidates compared = finding->set;
  for (const CandidatePtr& candidate : OnePerName(finding->tried)) {
    if (compared.size() >= kCompared) break;
    const auto same = [&](const CandidatePtr& other) { return other->names() == candidate->names(); };
    if (std::none_of(compared.begin(), compared.end(), same)) compared.push_back(candidate);
  }
  Matrix scores(kNumBlocks, static_cast<Eigen::Index>(compared.size()));
  for (std::size_t i = 0; i < compared.size(); ++i)
    scores.col(static_cast<Eigen::Index>(i)) = compared[i]->fit.heldout - base_->fit.heldout;
  const Vector share = bootstrap_->SoftShare(scores, std::max(Margin() / kMarginOdds, 1.0));
  for (std::size_t i = 0; i < compared.size(); ++i)
    compared[i]->probability = finding->p_missing * (1.0 - finding->p_unnamed) * share[static_cast<Eigen::Index>(i)];
}

}  // namespace armcmc::gap
