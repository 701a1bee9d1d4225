#include "describe.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <utility>

#include "armcmc/gap/separation.hpp"

namespace armcmc::gap {
namespace {

constexpr std::size_t kListed = 20;     // by their scores,
constexpr double kWorthListing = 1e-3;  // and all that are as probable
constexpr double kLikely = 0.5;

/// What the fit determines of its parameters; those of the added effects are called EFFECT_NAME.
Separation SeparationOf(const Fitted& fit, const std::vector<Term>& added, const Matrix& covariance) {
  std::vector<FittedParameter> parameters;
  for (Eigen::Index c = 0; c < fit.theta.size(); ++c) {
    const Coordinate& coordinate = fit.coordinates[static_cast<std::size_t>(c)];
    parameters.push_back({coordinate.name, coordinate.unit, coordinate.Value(fit.theta[c]), coordinate.logarithmic});
  }
  auto at = parameters.rbegin();
  for (auto term = added.rbegin(); term != added.rend(); ++term)
    for (int c = 0; c < term->form->size(); ++c, ++at) at->name.insert(0, term->form->effect + "_");
  const Vector slopes = Vector::NullaryExpr(fit.theta.size(), [&](Eigen::Index c) {
    const Coordinate& coordinate = fit.coordinates[static_cast<std::size_t>(c)];
    return coordinate.logarithmic ? 1.0 : coordinate.Slope(fit.theta[c]);
  });
  return Separate(parameters, slopes.asDiagonal() * covariance * slopes.asDiagonal());
}

/// @param determined  What the fit determines in place of parameters that are confounded is appended.
std::vector<EffectFinding> Effects(const Diagnosis& diagnosis, const CandidatePtr& candidate, int min_active,
                                   std::vector<Combination>* determined) {
  const Fitter& fitter = *diagnosis.wide->fitter;
  const Matrix covariance = candidate->fit.Covariance(fitter.whitener().variance);
  std::vector<EffectFinding> effects;
  int num_added = 0;
  for (const Term& term : candidate->added()) num_added += term.form->size();
  Eigen::Index at = candidate->fit.theta.size() - num_added;
  Separation separation = SeparationOf(candidate->fit, candidate->added(), covariance);
  determined->insert(determined->end(), separation.combinations.begin(), separation.combinations.end());
  for (const Term& term : candidate->added()) {
    EffectFinding effect;
    effect.name = term.form->effect;
    effect.family = term.form->family;
    effect.formula_text = term.form->formula;
    effect.probability = candidate->probability;
    effect.when = term.when;
    effect.approximate = diagnosis.finding.approximate || !term.form->exact();
    Vector energy = Vector::Zero(kNumBlocks);
    for (int a = 0; a < std::max(term.form->num_amplitudes, 1); ++a)
      energy += BlockSquares(candidate->fit.whitened_jacobian.col(at + a));
    effect.provisional = (energy.array() > 0.02 * energy.maxCoeff()).count() < min_active;
    for (int c = 0; c < term.form->size(); ++c, ++at) {
      const Coordinate& coordinate = term.form->coordinates[static_cast<std::size_t>(c)];
      effect.parameters.push_back(
          {coordinate.name, coordinate.unit, coordinate.Value(candidate->fit.theta[at]),
           std::abs(coordinate.Slope(candidate->fit.theta[at])) * std::sqrt(std::max(covariance(at, at), 0.0)),
           std::move(separation.confounded_with[static_cast<std::size_t>(at)])});
    }
    effects.push_back(std::move(effect));
  }
  return effects;
}

/// Two effects of one family that the data cannot distinguish may both act, and share what either would explain alone:
/// a latency may be part delay, part lag.
std::vector<std::vector<std::string>> PairsOfOneFamily(const Finding& finding) {
  std::vector<std::vector<std::string>> both;
  for (auto a = finding.set.begin(); a != finding.set.end(); ++a)
    for (auto b = std::next(a); b != finding.set.end(); ++b) {
      const bool single = (*a)->added().size() == 1 && (*b)->added().size() == 1;
      if (!single || (*a)->families() != (*b)->families() || !(*a)->always() || !(*b)->always()) continue;
      both.push_back({(*a)->names().front(), (*b)->names().front()});
      std::sort(both.back().begin(), both.back().end());
    }
  return both;
}

/// @param in  " in the flow law" where the plant has several equations.
std::string Sentence(const Result& result, const Finding& finding, const std::string& in) {
  const auto percent = [](double p) {
    char text[16];
    std::snprintf(text, sizeof(text), "%.0f %%", 100.0 * p);
    return std::string(text);
  };
  switch (result.verdict) {
    case Verdict::kNone: {
      if (result.probability_none >= kLikely) return "Nothing beyond the noise: the model explains these data.";
      const CandidatePtr weak = *std::max_element(
          finding.tried.begin(), finding.tried.end(),
          [](const CandidatePtr& a, const CandidatePtr& b) { return a->probability < b->probability; });
      return "Nothing that is large enough to be named: what may be missing is far below the noise, most probably " +
             Joined(Texts(weak), " and ") + " (" + percent(weak->probability) + ").";
    }
    case Verdict::kNamed:
      return "Missing" + in + ": " + Joined(Texts(finding.best), " and ") +
             (finding.approximate || !finding.best->exact() ? " (the family is right, the formula is approximate)"
                                                            : "") +
             ", with a probability of " + percent(finding.best->probability) + ".";
    case Verdict::kAmbiguous: {
      std::vector<std::string> sets;
      for (const CandidatePtr& candidate : finding.set) sets.push_back(Joined(Texts(candidate), " and "));
      for (const std::vector<std::string>& names : PairsOfOneFamily(finding)) sets.push_back(Joined(names, " and "));
      return "Missing" + in + ": one of " + Joined(sets, ", or ") + "; these data cannot tell which.";
    }
    case Verdict::kUnnamed: break;
  }
  return finding.unlisted ? "Something is missing" + in + " that is not in the catalogue; it looks like " +
                                Joined(Texts(finding.unlisted), " and ") + "."
                          : "Something is missing" + in + " that no effect of the catalogue explains.";
}

}  // namespace

std::string Joined(const std::vector<std::string>& words, const char* between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

std::vector<std::string> Texts(const CandidatePtr& candidate) {
  std::vector<std::string> texts;
  for (const Term& term : candidate->added()) texts.push_back(TermText(term));
  return texts;
}

void Describe(const Diagnosis& diagnosis, const std::string& in, int min_active, Result* result) {
  const Finding& finding = diagnosis.finding;
  result->verdict = finding.verdict;
  result->probability_none = finding.verdict == Verdict::kNone ? finding.p_none : 1.0 - finding.p_missing;
  result->probability_unnamed = finding.p_missing * finding.p_unnamed;
  if (!finding.set.empty()) result->effects = Effects(diagnosis, finding.best, min_active, &result->determined);
  if (finding.verdict == Verdict::kAmbiguous) {
    for (const CandidatePtr& candidate : finding.set) result->ambiguous_set.push_back(candidate->names());
    for (std::vector<std::string>& names : PairsOfOneFamily(finding)) result->ambiguous_set.push_back(std::move(names));
  }
  const double full = std::max(finding.gap, 1e-12);
  const auto rows = static_cast<double>(diagnosis.wide->signals.rows());
  for (std::size_t i = 0; i < finding.tried.size(); ++i) {
    const CandidatePtr& c = finding.tried[i];
    // What shows in few events only may be probable although no score on blocks left out says so.
    if (i >= kListed && c->probability < kWorthListing) continue;
    const double score = c->fit.score() - finding.base->fit.score();
    std::vector<std::string> texts = Texts(c);
    const std::vector<Term> added = c->added();
    for (std::size_t k = 0; k < texts.size(); ++k)
      if (!added[k].form->variant.empty()) texts[k] += " (" + added[k].form->variant + ")";
    result->candidates.push_back({texts, c->fit.log_evidence - finding.base->fit.log_evidence, score, c->probability,
                                  std::clamp(2.0 * score / rows / full, 0.0, 1.0)});
  }
  if (!finding.set.empty() && finding.best->correction)
    result->notes.push_back(finding.best->correction->listed
                                ? "the law may err, or " + finding.best->correction->what + " is there as well"
                                : "named beside something else that has no name: " + finding.best->correction->what);
  for (const double t : finding.events_s) {
    char note[96];
    std::snprintf(note, sizeof(note), "a single event at t = %.4g s that nothing of the catalogue explains", t);
    result->notes.emplace_back(note);
  }
  result->sentence = Sentence(*result, finding, in);
}

void DescribeOthers(const PlantDiagnosis& plant, int min_active, Result* result) {
  for (const EquationDiagnosis* other : plant.Others()) {
    const Finding& finding = other->diagnosis.finding;
    const std::string in = " in the " + other->equation->name();
    if (finding.verdict == Verdict::kNamed && result->verdict == Verdict::kNamed) {
      for (EffectFinding& effect : Effects(other->diagnosis, finding.best, min_active, &result->determined))
        result->effects.push_back(std::move(effect));
      result->sentence += " Missing" + in + ": " + Joined(Texts(finding.best), " and ") + ".";
      continue;
    }
    Result alone;
    alone.verdict = finding.verdict;
    result->notes.push_back(Sentence(alone, finding, in));
  }
}

}  // namespace armcmc::gap
