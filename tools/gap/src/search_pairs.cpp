// Pairs of effects: which, by which formulas, and with which onset.

#include <algorithm>
#include <set>

#include "armcmc/gap/gate_scan.hpp"
#include "armcmc/gap/search.hpp"
#include "armcmc/support/parallel.hpp"

namespace armcmc::gap {
namespace {

constexpr std::size_t kPairBeam = 4;      // singles that get partners
constexpr std::size_t kRefinedPairs = 3;  // pairs whose formulas and gates are refined

bool GatedBy(const Term& term) { return term.when.kind != When::Kind::kAlways; }

}  // namespace

Search::Candidates Search::GatedAlone(const Candidates& pairs, const Candidates& singles) const {
  Candidates alone;
  const auto same = [](const CandidatePtr& candidate, const Term& term) {
    const Term& other = candidate->fit.hypothesis.terms.back();
    return other.form == term.form && other.when.kind == term.when.kind && other.when.time_s == term.when.time_s;
  };
  for (std::size_t i = 0; i < std::min(kRefinedPairs, pairs.size()); ++i) {
    for (const Term& term : pairs[i]->added()) {
      const auto known = [&](const CandidatePtr& candidate) { return same(candidate, term); };
      if (!GatedBy(term) || std::any_of(singles.begin(), singles.end(), known) ||
          std::any_of(alone.begin(), alone.end(), known))
        continue;
      alone.push_back(Make(fitter_->Add(base_->fit, term)));
    }
  }
  return alone;
}

CandidatePtr Search::Ungated(const CandidatePtr& pair) const {
  CandidatePtr ungated = base_;
  for (const Term& term : pair->added())
    for (const EffectForm& form : *catalogue_)
      if (form.exact() && form.effect == term.form->effect) ungated = Make(fitter_->Add(ungated->fit, {&form, {}}));
  return ungated;
}

CandidatePtr Search::Refined(const CandidatePtr& pair) const {
  CandidatePtr best = pair;
  // Two gates may depend on each other: a bias and a drift that cancel half-way both seem to end there.
  if (!pair->always()) {
    const CandidatePtr ungated = Ungated(pair);
    if (ungated->names() == pair->names() && !Better(pair->fit, ungated->fit)) best = ungated;
  }
  // Refines each member, given the other: any formula of the same effect, any gate.
  for (std::size_t member = pair->num_known; member < pair->fit.hypothesis.terms.size(); ++member) {
    Hypothesis others;
    std::vector<double> theta;
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
          if (gate.gain - gate.always_gain > limits_.min_gain * rows_ * fitter_->whitener().variance)
            tries.push_back(gate.term);
      for (const Term& term : tries) {
        CandidatePtr other = Make(fitter_->Add(parent->fit, term));
        const bool simpler = !GatedBy(term) && form.exact();
        const double lead = other->fit.score() - best->fit.score();
        const bool drops_gate =
            simpler && GatedBy(best->fit.hypothesis.terms[member]) && !Better(best->fit, other->fit);
        if (drops_gate || (simpler ? lead > 0.0 : Better(other->fit, best->fit))) best = other;
      }
    }
  }
  return best;
}

Search::Candidates Search::Pairs(const Candidates& order, const CandidatePtr& parent,
                                 const Candidates& extended) const {
  Candidates pairs;
  std::set<std::vector<std::string>> beam;
  for (const CandidatePtr& first : order) {
    if (beam.size() >= kPairBeam) break;
    if (Gain(first) < limits_.min_gain || !beam.insert(first->names()).second) continue;
    const Candidates partners = first == parent ? extended : Extend(first, false);
    pairs.insert(pairs.end(), partners.begin(), partners.end());
  }
  SortByScore(&pairs);
  pairs = OnePerName(pairs);
  (void)base_->fit.basis();
  support::InParallel(std::min(kRefinedPairs, pairs.size()), [&](std::size_t i) { pairs[i] = Refined(pairs[i]); });
  SortByScore(&pairs);
  return pairs;
}

}  // namespace armcmc::gap
