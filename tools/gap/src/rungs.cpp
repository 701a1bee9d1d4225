#include "rungs.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "describe.hpp"

namespace armcmc::gap {
namespace {

using Names = std::vector<std::string>;  // sorted

Names Without(const Names& names, const Names& others) {
  Names rest;
  std::set_difference(names.begin(), names.end(), others.begin(), others.end(), std::back_inserter(rest));
  return rest;
}

/// What all sets have in common.
Names Common(const std::vector<CandidatePtr>& set) {
  Names common = set.front()->names();
  for (const CandidatePtr& candidate : set) {
    const Names names = candidate->names();
    Names both;
    std::set_intersection(common.begin(), common.end(), names.begin(), names.end(), std::back_inserter(both));
    common = std::move(both);
  }
  return common;
}

/// The best hypothesis with one effect more than `known`, of those in `all`; null: none was tried.
CandidatePtr Next(const Finding& finding, const Names& known, const Names& all) {
  for (const CandidatePtr& candidate : finding.tried) {
    const Names names = candidate->names();
    if (names.size() == known.size() + 1 && std::includes(names.begin(), names.end(), known.begin(), known.end()) &&
        std::includes(all.begin(), all.end(), names.begin(), names.end()))
      return candidate;
  }
  return nullptr;
}

bool AnyProvisional(const Result& result, const Names& names) {
  return std::any_of(result.effects.begin(), result.effects.end(), [&](const EffectFinding& effect) {
    return effect.provisional && std::find(names.begin(), names.end(), effect.name) != names.end();
  });
}

}  // namespace

void WriteRungs(const Equation& equation, const HeldOut& heldout, const Diagnosis& diagnosis, Result* result) {
  const Finding& finding = diagnosis.finding;
  result->complete = finding.verdict == Verdict::kNone || (!finding.set.empty() && !finding.approximate);
  result->remainder.share = result->complete ? 0.0
                            : finding.set.empty()
                                ? 1.0
                                : std::clamp(finding.remainder / std::max(finding.gap, 1e-12), 0.0, 1.0);
  if (finding.verdict == Verdict::kUnnamed) {
    result->remainder.where = result->where;
    result->remainder.sparse = result->sparse;
  }
  if (finding.set.empty()) return;

  const auto write = [&](Names effects, const CandidatePtr& with) {
    const GapSummary gap = ShowGap(equation, heldout, *diagnosis.bootstrap, finding.base->fit, with->fit, nullptr);
    LadderRung rung;
    rung.effects = std::move(effects);
    rung.closed_fraction = gap.closed_fraction;
    rung.heldout_error = gap.after.rmse;
    rung.probability = with->probability;
    rung.remainder_ratio = gap.after.rmse / std::max(gap.noise_floor, 1e-300);
    rung.provisional = AnyProvisional(*result, rung.effects);
    result->ladder.push_back(std::move(rung));
  };
  // An effect of every hypothesis is as probable as all of them together.
  double together = 0.0;
  for (const CandidatePtr& candidate : finding.set) together += candidate->probability;
  Names named;
  const Names sure = Common(finding.set);
  const bool tie = finding.set.size() > 1;
  while (named.size() + (tie ? 0 : 1) < sure.size()) {
    const CandidatePtr next = Next(finding, named, sure);
    if (next == nullptr) break;
    write(Without(next->names(), named), next);
    result->ladder.back().probability = together;
    named = next->names();
  }
  // If it is open whether anything more is missing, the ladder ends with the certain effects.
  if (Without(finding.best->names(), named).empty()) return;
  Names last;
  for (const CandidatePtr& candidate : finding.set) {
    const std::string rest = Joined(Without(candidate->names(), named), " + ");
    if (!rest.empty() && std::find(last.begin(), last.end(), rest) == last.end()) last.push_back(rest);
  }
  write(std::move(last), finding.best);
  result->ladder.back().provisional = AnyProvisional(*result, Without(finding.best->names(), named));
}

}  // namespace armcmc::gap
