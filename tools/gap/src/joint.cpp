#include "armcmc/gap/joint.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

namespace armcmc::gap {
namespace {

constexpr double kSame = 0.02;       // relative difference up to which two experiments count as the same
constexpr double kMarginOdds = 3.0;  // log odds that a margin is worth
constexpr double kDecides = 10.0;    // nats; what a proposed experiment is to bring, too
constexpr double kNearBound = 0.5;
constexpr int kJointSteps = 30;

/// A member of the first recording's set, with its evidence in the second.
struct Asked {
  CandidatePtr candidate;
  double log_predictive = 0.0;  ///< log p(second | first), up to what all members share.
};

/// The same effects in the wide analysis of the first recording, whichever proposed them. Nothing where a term was over
/// before the second recording began.
std::optional<Fitted> InWideAnalysis(const Analysis& analysis, const CandidatePtr& member) {
  Fitted fit = analysis.finding.base->fit;
  for (const Term& term : member->added()) {
    if (term.when.kind == When::Kind::kUntil) return std::nullopt;
    const auto form = std::find_if(analysis.catalogue.begin(), analysis.catalogue.end(), [&](const EffectForm& f) {
      return f.effect == term.form->effect && f.variant == term.form->variant;
    });
    if (form == analysis.catalogue.end()) return std::nullopt;
    fit = analysis.fitter->Add(fit, {&*form, term.when});
  }
  return fit;
}

/// Posterior of the coordinates from `first` on, base parameters integrated out, as prior of another fit. Two
/// recordings of one effect agree within kSame at best, and each has its own events.
CoordinatePrior PriorFrom(const Fitted& fit, double variance, Eigen::Index first) {
  const Eigen::Index size = fit.theta.size(), count = size - first;
  Matrix hessian = fit.whitened_jacobian.transpose() * fit.whitened_jacobian / variance;
  for (Eigen::Index i = 0; i < size; ++i)
    hessian(i, i) += std::pow(fit.coordinates[static_cast<std::size_t>(i)].prior_sd, -2);
  Matrix covariance = hessian.ldlt().solve(Matrix::Identity(size, size)).bottomRightCorner(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Coordinate& c = fit.coordinates[static_cast<std::size_t>(first + i)];
    covariance(i, i) += std::pow(kSame * (c.logarithmic ? 1.0 : std::abs(fit.theta[first + i])), 2) + 1e-300;
    if (c.event) covariance(i, i) += c.prior_sd * c.prior_sd;
  }
  CoordinatePrior prior{fit.theta, Matrix::Zero(size, size)};
  prior.precision.bottomRightCorner(count, count) = covariance.ldlt().solve(Matrix::Identity(count, count));
  return prior;
}

double LogDeterminant(const Matrix& matrix) { return matrix.ldlt().vectorD().cwiseMax(1e-300).array().log().sum(); }

/// log p(second | first) up to a constant; base parameters with the prior of their coordinates.
double LogPredictive(const Fitted& fit, const CoordinatePrior& prior, double variance, Eigen::Index first) {
  const Vector off = fit.theta - prior.mean;
  Matrix hessian = fit.whitened_jacobian.transpose() * fit.whitened_jacobian / variance + prior.precision;
  for (Eigen::Index i = 0; i < first; ++i)
    hessian(i, i) += std::pow(fit.coordinates[static_cast<std::size_t>(i)].prior_sd, -2);
  const Eigen::Index count = fit.theta.size() - first;
  const double prior_term = count > 0 ? LogDeterminant(prior.precision.bottomRightCorner(count, count)) : 0.0;
  return -0.5 * fit.squares / variance - 0.5 * off.dot(prior.precision * off) +
         0.5 * (prior_term - LogDeterminant(hessian));
}

/// The second recording in the units of the first.
std::unique_ptr<Analysis> AnalyseLike(const Equation& equation, const Recording& recording, const Analysis& first,
                                      const Diagnosis& second, const Thresholds& thresholds) {
  auto analysis = std::make_unique<Analysis>();
  analysis->signals = equation.PrepareLike(recording, second.wide->signals.window, first.signals);
  analysis->signals.window = second.wide->signals.window;
  analysis->signals.law_seen = second.wide->signals.law_seen;
  analysis->signals.origin = analysis->signals.t[0];
  analysis->catalogue = first.catalogue;
  analysis->fitter = std::make_unique<Fitter>(equation, analysis->signals, second.wide->fitter->whitener());
  const Fitted& base = first.finding.base->fit;
  analysis->search = std::make_unique<Search>(*analysis->fitter, analysis->catalogue, *second.bootstrap, thresholds,
                                              analysis->fitter->Fit(base.hypothesis, base.theta, kJointSteps));
  analysis->finding = second.finding;
  analysis->finding.base = analysis->search->base();
  return analysis;
}

std::vector<Asked> CompareMembers(const Analysis& first, const Analysis& analysis,
                                  const std::vector<CandidatePtr>& members) {
  const Eigen::Index num_base = analysis.finding.base->fit.theta.size();
  std::vector<Asked> asked;
  for (const CandidatePtr& member : members) {
    const std::optional<Fitted> before = InWideAnalysis(first, member);
    if (!before) continue;
    const CoordinatePrior prior = PriorFrom(*before, first.fitter->whitener().variance, num_base);
    Hypothesis hypothesis = before->hypothesis;
    for (Term& term : hypothesis.terms)
      if (term.when.kind == When::Kind::kFrom) term.when = {};
    Asked one;
    one.candidate = std::make_shared<Candidate>();
    one.candidate->num_known = analysis.finding.base->num_known;
    Vector start = before->theta;
    start.head(num_base) = analysis.finding.base->fit.theta;
    one.candidate->fit = analysis.fitter->Fit(hypothesis, start, kJointSteps, &prior);
    one.log_predictive = LogPredictive(one.candidate->fit, prior, analysis.fitter->whitener().variance, num_base);
    asked.push_back(std::move(one));
  }
  std::stable_sort(asked.begin(), asked.end(),
                   [](const Asked& a, const Asked& b) { return a.log_predictive > b.log_predictive; });
  return asked;
}

bool Among(const std::vector<CandidatePtr>& set, const CandidatePtr& candidate) {
  return std::any_of(set.begin(), set.end(),
                     [&](const CandidatePtr& other) { return other->names() == candidate->names(); });
}

std::string Decision(const std::vector<Asked>& asked) {
  std::string text = "judged by both recordings:";
  for (const Asked& one : asked) {
    std::string names;
    for (const Term& term : one.candidate->added()) names += (names.empty() ? "" : " and ") + TermText(term);
    char nats[48];
    std::snprintf(nats, sizeof(nats), " (%.1f nats)", one.log_predictive - asked.front().log_predictive);
    text += (&one == &asked.front() ? " " : ", ") + names + nats;
  }
  return text;
}

}  // namespace

void Join(const Equation& equation, const Recording& recording, const Diagnosis& first, const Thresholds& thresholds,
          Diagnosis* second, std::vector<std::string>* notes) {
  if (first.finding.set.empty()) return;
  if (second->finding.verdict == Verdict::kNamed && Among(first.finding.set, second->finding.best)) return;
  std::unique_ptr<Analysis> analysis = AnalyseLike(equation, recording, *first.wide, *second, thresholds);
  std::vector<CandidatePtr> members = first.finding.set;
  // What the second leaves open by itself narrows the set, unless the two exclude each other.
  const auto excluded = [&](const CandidatePtr& member) { return !Among(second->finding.set, member); };
  if (second->finding.verdict == Verdict::kAmbiguous && !std::all_of(members.begin(), members.end(), excluded))
    std::erase_if(members, excluded);
  std::vector<Asked> asked = CompareMembers(*first.wide, *analysis, members);
  if (asked.empty()) return;
  Finding finding = second->finding;
  finding.base = analysis->finding.base;
  const auto rows = static_cast<double>(analysis->signals.rows());
  const double variance = analysis->fitter->whitener().variance;
  const double gain = 0.5 * (finding.base->fit.squares - asked.front().candidate->fit.squares) / variance;
  if (gain < -thresholds.tie_nats) {
    notes->push_back("the recordings disagree: what the earlier one leaves open makes this one worse");
    return;
  }
  if (finding.verdict != Verdict::kNone && !analysis->search->Adequate(asked.front().candidate, finding.gap)) {
    notes->push_back("the recordings disagree: what the earlier one leaves open does not explain this one");
    return;
  }
  notes->push_back(Decision(asked));
  finding.gap = std::max(finding.gap, 2.0 * gain / rows);
  finding.set.clear();
  double total = 0.0;
  // A lead larger than all that the best one leaves unexplained cannot be due to an error of its formula; nor can one
  // close to its expectation, which is D if the best one is true and -D if the other is.
  const auto margin = [&](const Asked& one) {
    const Vector apart = analysis->fitter->whitener().Apply(
        Vector(asked.front().candidate->fit.predicted - one.candidate->fit.predicted));
    return std::max({kDecides, 0.5 * rows * thresholds.tie_effect * thresholds.tie_effect,
                     kNearBound * 0.5 * apart.squaredNorm() / variance,
                     analysis->search->Left(asked.front().candidate)});
  };
  const auto odds = [&](const Asked& one) {
    return std::exp((one.log_predictive - asked.front().log_predictive) / std::max(margin(one) / kMarginOdds, 1.0));
  };
  for (const Asked& one : asked) total += odds(one);
  finding.p_missing = std::max(finding.p_missing, first.finding.p_missing);
  finding.p_unnamed = std::min(finding.p_unnamed, first.finding.p_unnamed);
  finding.tried.clear();
  for (const Asked& one : asked) {
    one.candidate->probability = finding.p_missing * (1.0 - finding.p_unnamed) * odds(one) / total;
    one.candidate->fit.log_evidence =
        finding.base->fit.log_evidence + one.log_predictive + 0.5 * finding.base->fit.squares / variance;
    finding.tried.push_back(one.candidate);
    if (asked.front().log_predictive - one.log_predictive < margin(one)) finding.set.push_back(one.candidate);
  }
  finding.best = finding.set.front();
  finding.verdict = finding.set.size() == 1 ? Verdict::kNamed : Verdict::kAmbiguous;
  finding.approximate = finding.approximate && second->finding.verdict == Verdict::kNamed;
  finding.unlisted = nullptr;
  finding.events_s.clear();
  analysis->finding = finding;
  second->finding = finding;
  second->wide = std::move(analysis);
}

}  // namespace armcmc::gap
