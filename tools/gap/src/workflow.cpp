#include "armcmc/gap/workflow.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "armcmc/gap/aliases.hpp"
#include "armcmc/gap/figures.hpp"
#include "armcmc/gap/joint.hpp"
#include "armcmc/gap/localise.hpp"
#include "armcmc/gap/model_writer.hpp"
#include "armcmc/gap/online_part.hpp"
#include "armcmc/gap/plant_diagnosis.hpp"
#include "armcmc/gap/verify.hpp"
#include "confirm.hpp"
#include "describe.hpp"
#include "rungs.hpp"
#include "sparse.hpp"

namespace armcmc::gap {
namespace {

constexpr double kDiagnosisShare = 0.7;  // of the recording is diagnosed; the rest is held out until the end
constexpr double kLeastCoverage = 0.85;  // of the 95 % bands on held-out data, for a model that holds; and
constexpr double kMostWhiteness = 5.0;   // Ljung-Box statistic over its degrees of freedom there

/// Measures the time of each step and reports progress.
class Clock {
 public:
  Clock(const WorkflowRequest& request, Result* result) : request_(request), result_(result) {}
  void Begin(const std::string& step, double share) {
    End();
    step_ = step;
    start_ = std::chrono::steady_clock::now();
    if (request_.progress) request_.progress(step, share);
  }
  void End() {
    if (!step_.empty())
      result_->seconds.emplace_back(step_,
                                    std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count());
    step_.clear();
  }

 private:
  const WorkflowRequest& request_;
  Result* result_;
  std::string step_;
  std::chrono::steady_clock::time_point start_;
};

/// Standard deviation of the noise, in the unit of the output.
double NoiseSd(const Diagnosis& diagnosis) {
  const Whitener& whitener = diagnosis.wide->fitter->whitener();
  return std::sqrt(whitener.variance * whitener.Gain());
}

const Fitted* Control(const Finding& finding) {
  for (const CandidatePtr& candidate : finding.tried) {
    const auto same = [&](const CandidatePtr& other) { return other->names() == candidate->names(); };
    const bool listed = std::all_of(candidate->fit.hypothesis.terms.begin(), candidate->fit.hypothesis.terms.end(),
                                    [](const Term& term) { return term.form->listed; });
    if (listed && candidate->added().size() == finding.best->added().size() &&
        std::none_of(finding.set.begin(), finding.set.end(), same))
      return &candidate->fit;
  }
  return nullptr;
}

/// The model for the estimator, with notes on effects that it leaves out or represents by another formula.
std::optional<EstimatorSettings> Add(const WorkflowRequest& request, const PlantDiagnosis& plant,
                                     const HeldOut& heldout, Result* result) {
  const OnlinePart part = OnlinePartOf(plant);
  const EquationDiagnosis& carrying = plant.carrying();
  if (!part.left_out.empty())
    result->notes.push_back(
        Joined(part.left_out, ", ") + ": for offline fits only. The estimator estimates no effects of the " +
        carrying.equation->name() +
        (part.equation == nullptr ? ", so that no model file is written" : ": the model file leaves them out"));
  if (part.equation == nullptr) return std::nullopt;
  const Diagnosis& diagnosis = part.equation->diagnosis;
  if (part.equation != &carrying)
    result->notes.push_back("the estimator runs it in the " + part.equation->equation->name() +
                            ", with the parameters that are fitted there");
  if (part.equation == &carrying && part.other_formula) {
    char note[160];
    std::snprintf(
        note, sizeof(note),
        "the estimator runs the catalogue's formula, which by itself closes %.0f %% of the gap and is refitted "
        "at every pack",
        100.0 *
            ShowGap(*carrying.equation, heldout, *diagnosis.bootstrap, diagnosis.finding.base->fit, part.fit, nullptr)
                .closed_fraction);
    result->notes.emplace_back(note);
  }
  return AugmentedSettings(request.model, *diagnosis.wide->fitter, part.fit, NoiseSd(diagnosis));
}

/// The rows to diagnose, and the recording whose rows from `first_shown` on are held out.
struct Parts {
  Recording diagnosis, shown;
  Eigen::Index first_shown = 0;
};

Parts Divide(const WorkflowRequest& request) {
  if (request.heldout) return {request.data, *request.heldout, 0};
  const auto rows = static_cast<Eigen::Index>(kDiagnosisShare * static_cast<double>(request.data.rows()));
  Parts parts{request.data.Slice(0, rows), request.data, rows};
  parts.diagnosis.source += ": first 70 % of " + std::to_string(request.data.rows()) + " samples";
  return parts;
}

HeldOut EvaluateHeldOut(const EquationDiagnosis& one, const Parts& parts) {
  return {*one.equation, *one.diagnosis.wide, parts.shown, parts.first_shown};
}

/// Whether the held-out rows contradict the model that explains the first part: the coverage of its 95 % bands is far
/// too low, or its residual is far from white.
bool HeldOutRowsContradict(const EquationDiagnosis& one, const HeldOut& rest) {
  const Finding& finding = one.diagnosis.finding;
  const CandidatePtr& best = finding.set.empty() ? finding.base : finding.best;
  const Fit fit = rest.Judge(rest.Try(best->correction ? best->correction->with : best->fit));
  return fit.coverage95 < kLeastCoverage || fit.whiteness > kMostWhiteness;
}

/// Whether the named effect is so small that the held-out rows can neither confirm nor contradict it.
bool HeldOutIsInconclusive(const EquationDiagnosis& one, const HeldOut& rest) {
  const Diagnosis& diagnosis = one.diagnosis;
  if (diagnosis.finding.set.empty()) return false;
  return ShowGap(*one.equation, rest, *diagnosis.bootstrap, diagnosis.finding.base->fit, diagnosis.finding.best->fit,
                 nullptr)
             .gap_ratio < kUnseenRatio;
}

/// Whether an equation shows events that nothing explains, or a gap in the held-out rows only: a load may be picked up
/// late.
bool ShowsMoreLater(const EquationDiagnosis& one, const Parts& parts) {
  const Finding& finding = one.diagnosis.finding;
  if (!one.suitability.can_name) return false;
  if (finding.verdict == Verdict::kUnnamed) return !finding.events_s.empty();
  return finding.verdict == Verdict::kNone && HeldOutRowsContradict(one, EvaluateHeldOut(one, parts));
}

/// Whether to diagnose the whole recording as well, which costs as much as the first diagnosis. Always for a plant with
/// several equations if the first part shows no gap.
bool NeedsWholeRecording(const WorkflowRequest& request, const Parts& parts, const HeldOut& rest,
                         const PlantDiagnosis& plant) {
  if (request.heldout || request.diagnose.law_errs || !plant.carrying().suitability.can_name) return false;
  const Finding& first = plant.carrying().diagnosis.finding;
  const bool several = plant.equations.size() > 1;
  if (first.verdict == Verdict::kUnnamed)
    return several && std::any_of(plant.equations.begin(), plant.equations.end(),
                                  [&](const EquationDiagnosis& one) { return ShowsMoreLater(one, parts); });
  return (several && first.verdict == Verdict::kNone) || HeldOutRowsContradict(plant.carrying(), rest) ||
         HeldOutIsInconclusive(plant.carrying(), rest);
}

/// Diagnoses the whole recording if its first part shows no gap, shows single events that nothing explains, or suggests
/// a name that the held-out rows contradict or cannot confirm. An effect may act only in free motion, or only at high
/// force, which the first part may lack; and a chance correlation does not persist over a whole recording.
/// @param rest  The held-out rows, under the diagnosis of the first part.
/// @return a note on the change, and then `plant` is the diagnosis of the whole recording; empty if nothing changes.
std::string DiagnoseAll(const WorkflowRequest& request, const Parts& parts, const HeldOut& rest,
                        PlantDiagnosis* plant) {
  if (!NeedsWholeRecording(request, parts, rest, *plant)) return {};
  PlantDiagnosis whole = DiagnosePlant(request.model, request.data, request.diagnose);
  const Finding& first = plant->carrying().diagnosis.finding;
  const Finding& all = whole.carrying().diagnosis.finding;
  const bool nothing = all.verdict == Verdict::kNone;
  std::string found = "the gap occurs in the last 30 % of the recording only";
  if (first.set.empty()) {
    if (first.verdict == Verdict::kNone ? nothing : all.set.empty()) return {};
  } else {
    if (HeldOutRowsContradict(whole.carrying(), EvaluateHeldOut(whole.carrying(), parts))) return {};
    const std::string named = "the first 70 % of the recording name " + Joined(Texts(first.best), " and ");
    found = named + ", which the rest contradicts";
    if (nothing) {
      *plant = std::move(whole);
      return named + ", all of it shows nothing beyond the noise";
    }
    const bool other = !all.set.empty() && NamesOf(all) != NamesOf(first);
    if (!other || !HeldOutRowsContradict(plant->carrying(), rest)) return {};
  }
  *plant = std::move(whole);
  found += ": no data were held out, and the gap is evaluated on diagnosed data. ";
  return found + "Record another run for --heldout";
}

/// Compares the effects that an earlier recording could not separate, on both recordings together.
/// @return the earlier diagnosis, to which the candidates of `plant` refer.
PlantDiagnosis JoinEarlier(const WorkflowRequest& request, const Recording& recording, PlantDiagnosis* plant) {
  PlantDiagnosis earlier = DiagnosePlant(request.model, *request.earlier, request.diagnose);
  if (earlier.carrying().diagnosis.finding.set.empty()) {
    plant->notes.push_back(request.earlier->source + ": not used, since no effect is named on it alone");
    return earlier;
  }
  EquationDiagnosis& same = plant->equations[earlier.carrier];
  if (!same.suitability.can_name) return earlier;
  plant->carrier = earlier.carrier;
  Join(*same.equation, recording, earlier.carrying().diagnosis, request.diagnose.thresholds, &same.diagnosis,
       &plant->notes);
  return earlier;
}

}  // namespace

WorkflowOutcome RunWorkflow(const WorkflowRequest& request) {
  WorkflowOutcome outcome;
  Result& result = outcome.result;
  Clock clock(request, &result);
  const Parts parts = Divide(request);
  result.model = request.model;
  result.data_file = request.data.source;
  result.seed = request.diagnose.seed;
  result.rows = request.data.rows();
  result.dt = request.data.dt;
  result.notes = request.data.notes;

  clock.Begin("compare and name", 0.0);
  PlantDiagnosis plant = DiagnosePlant(request.model, parts.diagnosis, request.diagnose);
  if (request.diagnose.law_errs && plant.carrying().diagnosis.finding.set.empty()) {
    result.verdict = Verdict::kUnnamed;
    return outcome;
  }
  std::optional<HeldOut> rest(EvaluateHeldOut(plant.carrying(), parts));
  const std::string whole_note = DiagnoseAll(request, parts, *rest, &plant);
  if (!whole_note.empty()) result.notes.push_back(whole_note);
  std::optional<PlantDiagnosis> earlier;
  if (request.earlier) earlier = JoinEarlier(request, parts.diagnosis, &plant);
  const Equation* equation = plant.carrying().equation.get();
  Diagnosis& diagnosis = plant.carrying().diagnosis;
  const std::string in = equation->name().empty() ? "" : " in the " + equation->name();
  result.equation = equation->name();
  result.notes.insert(result.notes.end(), plant.notes.begin(), plant.notes.end());
  const Analysis& analysis = *diagnosis.wide;
  result.notes.insert(result.notes.end(), diagnosis.notes.begin(), diagnosis.notes.end());
  if (!analysis.signals.law_seen)
    result.notes.push_back("hardly any " + equation->active_name() +
                           " in these data: they say nothing about the law and its parameters");
  const bool can_name = plant.carrying().suitability.can_name;
  if (request.until >= Step::kFind && can_name) {
    clock.Begin("find where", 0.6);
    result.where = FindWhere(*equation, analysis, *diagnosis.bootstrap, request.diagnose.seed);
    for (Where& where : result.where)
      if (!equation->name().empty()) where.feature = equation->name() + ": " + where.feature;
  }
  if (can_name) result.aliases = Aliases(*equation, analysis);
  if (!whole_note.empty() || earlier) rest.emplace(EvaluateHeldOut(plant.carrying(), parts));
  const HeldOut& heldout = *rest;
  if (request.until >= Step::kShow && !diagnosis.finding.set.empty()) {
    clock.Begin("confirm", 0.72);
    Confirm(*equation, heldout, request.diagnose, &diagnosis, &result);
  }
  if (request.until < Step::kName) {
    result.sentence = "The search for a name was not requested.";
    result.probability_none = result.probability_unnamed = std::numeric_limits<double>::quiet_NaN();
  }
  const int min_active = request.diagnose.thresholds.min_active_blocks;
  if (request.until >= Step::kName && can_name) {
    Describe(diagnosis, in, min_active, &result);
    DescribeOthers(plant, min_active, &result);
    if (result.verdict == Verdict::kUnnamed) result.sparse = DescribeSparsely(*equation, diagnosis);
  }
  const auto mute = std::find_if(plant.equations.begin(), plant.equations.end(),
                                 [](const EquationDiagnosis& one) { return one.suitability.needs_excitation; });
  if (request.until >= Step::kName && mute != plant.equations.end()) {
    // No verdict on this equation: these data could not have shown an effect.
    if (result.verdict == Verdict::kNone) result.sentence = "Nothing is named. " + mute->suitability.note + ".";
    result.separate_by = mute->equation->Separate(*mute->diagnosis.wide, {});
  }
  if (request.until >= Step::kName && diagnosis.finding.verdict == Verdict::kAmbiguous) {
    clock.Begin("choose an experiment", 0.7);
    result.separate_by = equation->Separate(analysis, diagnosis.finding.set);
  }
  const bool adds = !diagnosis.finding.set.empty();
  const Fitted after = adds ? diagnosis.finding.best->fit : diagnosis.finding.base->fit;
  if (request.until >= Step::kAdd && adds) {
    clock.Begin("add", 0.75);
    outcome.augmented = Add(request, plant, heldout, &result);
  }
  if (request.until >= Step::kShow) {
    clock.Begin("show", 0.8);
    const Fitted& before = diagnosis.finding.base->fit;
    result.gap =
        ShowGap(*equation, heldout, *diagnosis.bootstrap, before, after, adds ? Control(diagnosis.finding) : nullptr);
    const auto report = [&](const Fitted& fit) {
      return equation->Report(analysis.signals, fit.theta, fit.Covariance(analysis.fitter->whitener().variance));
    };
    const auto first = report(before), second = report(after);
    for (std::size_t i = 0; analysis.signals.law_seen && i < first.size(); ++i)
      result.parameters.push_back({first[i], second[i]});
    const Signals all = equation->PrepareLike(parts.shown, analysis.signals.window, analysis.signals);
    result.figures = MakeFigures(*equation, all, analysis, before, after);
    if (can_name) WriteRungs(*equation, heldout, diagnosis, &result);
    // A gap in another equation, or one that these data could not have shown, remains as well.
    const std::vector<const EquationDiagnosis*> others = plant.Others();
    result.complete = result.complete && mute == plant.equations.end() &&
                      std::all_of(others.begin(), others.end(), [](const EquationDiagnosis* other) {
                        return other->diagnosis.finding.verdict == Verdict::kNamed;
                      });
    result.figures.diagnosis_end_s =
        request.heldout ? std::numeric_limits<double>::quiet_NaN() : parts.shown.t[parts.first_shown];
  }
  clock.End();
  if (request.progress) request.progress("done", 1.0);
  return outcome;
}

std::optional<WorkflowOutcome> RunBesideLawError(WorkflowRequest request) {
  if (request.until < Step::kShow || !request.diagnose.pairs || request.earlier) return std::nullopt;
  request.diagnose.law_errs = true;
  WorkflowOutcome outcome = RunWorkflow(request);
  if (outcome.result.effects.empty()) return std::nullopt;
  return outcome;
}

}  // namespace armcmc::gap
