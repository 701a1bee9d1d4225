#include "confirm.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "describe.hpp"

namespace armcmc::gap {
namespace {

constexpr double kWorse = 1.005;  // largest ratio of the held-out error with and without a named effect
constexpr double kComparable =
    16.0;  // squared difference of two models on held-out data, in noise variances, that suffices to compare them

/// Compares hypotheses with the held-out data.
class OnHeldOut {
 public:
  OnHeldOut(const Equation& equation, const HeldOut& heldout, const Thresholds& limits, const Diagnosis& diagnosis)
      : equation_(equation), heldout_(heldout), limits_(limits), diagnosis_(diagnosis) {}

  /// Whether a hypothesis closes the gap; with a flexible correction, whether the effect adds to it, or does without.
  [[nodiscard]] bool Holds(const CandidatePtr& c) const {
    const GapSummary gap = Closed(Before(c), After(c));
    if (gap.gap_ratio < kUnseenRatio)
      return gap.after.rmse < kWorse * gap.before.rmse && !Contradict(Before(c), After(c));
    if (!c->correction) return gap.closed_high > limits_.confirmed && gap.closed_fraction > limits_.at_least_closed;
    const auto surely_closes = [&](const GapSummary& one) {
      return one.closed_low > 0.0 && one.closed_fraction > limits_.at_least_closed;
    };
    // The correction is fitted to the first part and may err on the rest by more than the model without it, so the
    // effect is judged by what it adds to it, and by what it explains alone.
    return surely_closes(gap) || surely_closes(AsReported(c));
  }
  /// Whether something else is at work in a few blocks only.
  [[nodiscard]] bool HoldsElsewhere(const CandidatePtr& c) const {
    return heldout_.ClosedOutsideWorstBlocks(Before(c), After(c)) > limits_.confirmed_elsewhere;
  }
  /// Whether the effect is there, be there something else as well.
  [[nodiscard]] bool FoundThere(const CandidatePtr& c) const {
    return heldout_.FoundAsPredicted(Before(c), After(c), *diagnosis_.bootstrap) &&
           Closed(Before(c), After(c)).closed_fraction > limits_.at_least_closed;
  }
  /// Whether the effect is there beside an error of the law. Whether the model that is reported predicts better for it
  /// says little: it has no such error.
  [[nodiscard]] bool HoldsBesideLawError(const CandidatePtr& c) const {
    return heldout_.FoundBesideLawError(Before(c), After(c), *diagnosis_.bootstrap, limits_.at_least_closed);
  }
  [[nodiscard]] bool PredictsWorse(const CandidatePtr& c) const { return AsReported(c).closed_fraction < 0.0; }
  /// Whether the model that is reported, which has no correction, is no better than the one without the effect, and
  /// these data exclude that it closes a large part of the gap.
  [[nodiscard]] bool IsWorthless(const CandidatePtr& c) const {
    if (!c->correction) return false;
    const GapSummary gap = AsReported(c);
    return gap.gap_ratio >= kUnseenRatio && gap.closed_low <= 0.0 && gap.closed_high < limits_.at_least_closed;
  }

 private:
  [[nodiscard]] const Fitted& Base() const { return diagnosis_.finding.base->fit; }
  [[nodiscard]] const Fitted& Before(const CandidatePtr& c) const {
    return c->correction ? c->correction->without : Base();
  }
  [[nodiscard]] static const Fitted& After(const CandidatePtr& c) {
    return c->correction ? c->correction->with : c->fit;
  }
  [[nodiscard]] GapSummary Closed(const Fitted& before, const Fitted& after) const {
    return ShowGap(equation_, heldout_, *diagnosis_.bootstrap, before, after, nullptr);
  }
  [[nodiscard]] GapSummary AsReported(const CandidatePtr& c) const { return Closed(Base(), c->fit); }
  /// Whether held-out data contradict an effect that is so small that the share of the gap means nothing. If two models
  /// differ there by n noise variances, the sum of squares of the right one is smaller by n, give or take 2 sqrt(n).
  [[nodiscard]] bool Contradict(const Fitted& before, const Fitted& after) const {
    const Trial first = heldout_.Try(before), second = heldout_.Try(after);
    const double variance = diagnosis_.wide->fitter->whitener().variance;
    const double difference = (first.whitened - second.whitened).squaredNorm() / variance;
    return difference > kComparable && second.whitened.squaredNorm() >= first.whitened.squaredNorm();
  }

  const Equation& equation_;
  const HeldOut& heldout_;
  const Thresholds& limits_;
  const Diagnosis& diagnosis_;
};

/// The member itself if it holds, another formula of the same effects that does, or null. Notes say why.
CandidatePtr Confirmed(const OnHeldOut& data, const CandidatePtr& member, bool with_correction, Finding* finding,
                       std::vector<std::string>* notes) {
  const std::string text = Joined(Texts(member), " and ");
  const bool worthless = data.IsWorthless(member);
  if (!worthless && data.Holds(member)) return member;
  const auto other = std::find_if(finding->tried.begin(), finding->tried.end(), [&](const CandidatePtr& c) {
    return c != member && c->names() == member->names() && data.Holds(c);
  });
  const bool alone = other == finding->tried.end();
  if (alone && !worthless && data.HoldsElsewhere(member)) {
    notes->push_back("a few segments of the held-out data show something else that " + text +
                     " does not explain and the first part does not show");
    return member;
  }
  if (alone && !worthless && data.FoundThere(member)) {
    notes->push_back("the held-out data show " + text +
                     " as predicted, and beside it something else that the first part does not show");
    return member;
  }
  if (alone || with_correction) {
    notes->push_back(text + " explains the first part of the data but not the held-out part: rejected");
    return nullptr;
  }
  notes->push_back("on the held-out data " + text +
                   " holds only with another formula: " + (*other)->added().back().form->formula);
  (*other)->probability = member->probability;
  member->probability = 0.0;
  finding->approximate = true;
  return *other;
}

}  // namespace

void Confirm(const Equation& equation, const HeldOut& heldout, const DiagnoseOptions& options, Diagnosis* diagnosis,
             Result* result) {
  Finding& finding = diagnosis->finding;
  const OnHeldOut data(equation, heldout, options.thresholds, *diagnosis);
  // With such a correction only certain names are given: a set from which a member was rejected is not certain.
  const bool with_correction = std::any_of(finding.set.begin(), finding.set.end(),
                                           [](const CandidatePtr& member) { return member->correction != nullptr; });
  std::vector<CandidatePtr> kept;
  double lost = 0.0;
  for (const CandidatePtr& member : finding.set) {
    const CandidatePtr one = !options.law_errs ? Confirmed(data, member, with_correction, &finding, &result->notes)
                             : data.HoldsBesideLawError(member) ? member
                                                                : nullptr;
    if (one) {
      if (options.law_errs && data.PredictsWorse(one))
        result->notes.push_back("the law errs by so much that with " + Joined(Texts(one), " and ") +
                                " added it predicts the held-out part no better");
      kept.push_back(one);
      continue;
    }
    lost += member->probability;
    member->probability = 0.0;
  }
  if (kept.empty() || (with_correction && kept.size() < finding.set.size())) {
    kept.clear();
    finding.verdict = Verdict::kUnnamed;
    finding.p_unnamed = std::max(finding.p_unnamed, lost);
  } else {
    // The probability of the rejected hypotheses goes to the others.
    for (const CandidatePtr& member : kept) member->probability += lost / static_cast<double>(kept.size());
    finding.verdict = kept.size() == 1 ? Verdict::kNamed : Verdict::kAmbiguous;
    finding.best = kept.front();
  }
  finding.set = kept;
}

}  // namespace armcmc::gap
