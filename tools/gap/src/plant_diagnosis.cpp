#include "armcmc/gap/plant_diagnosis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>

namespace armcmc::gap {
namespace {

constexpr double kDecisive = 5.0;  // nats by which another equation rejects or confirms an effect
constexpr double kMostOdds = 50.0;

bool HasGap(const EquationDiagnosis& one) { return one.diagnosis.finding.verdict != Verdict::kNone; }

/// Log-likelihood ratio of an effect at a value that another equation found, over its absence.
std::optional<double> Evidence(const EquationDiagnosis& asked, const std::string& effect,
                               const std::vector<double>& values) {
  const Analysis& analysis = *asked.diagnosis.wide;
  for (const EffectForm& listed : analysis.catalogue) {
    if (!listed.exact() || listed.effect != effect || listed.coordinates.size() != values.size()) continue;
    EffectForm form = listed;
    std::vector<double> start;
    for (std::size_t c = 0; c < values.size(); ++c) {
      if (form.coordinates[c].logarithmic) return std::nullopt;
      start.push_back(values[c] / form.coordinates[c].unit_size);
      form.coordinates[c].lower = form.coordinates[c].upper = start.back();
    }
    const Fitted& base = analysis.finding.base->fit;
    Vector theta(base.theta.size() + form.size());
    theta << base.theta, Eigen::Map<const Vector>(start.data(), form.size());
    const double squares = analysis.fitter->Fit({{{&form, {}}}}, theta).squares;
    return 0.5 * (base.squares - squares) / analysis.fitter->whitener().variance;
  }
  return std::nullopt;
}

/// Multiplies the odds of one candidate against all other reported ones.
void Weigh(const CandidatePtr& candidate, double log_odds, Finding* finding) {
  double rest = finding->p_missing * finding->p_unnamed;
  for (const CandidatePtr& other : finding->tried) rest += other == candidate ? 0.0 : other->probability;
  const double all = rest + candidate->probability;
  if (!(candidate->probability > 0.0) || !(rest > 0.0)) return;
  const double odds = std::exp(std::min(log_odds, kMostOdds)) * candidate->probability / rest;
  const double given = all * odds / (1.0 + odds), share = (all - given) / rest;
  for (const CandidatePtr& other : finding->tried)
    if (other != candidate) other->probability *= share;
  finding->p_unnamed *= share;
  candidate->probability = given;
}

/// Asks the other equations, none of which has a gap, on the members of an ambiguous set.
void ResolveByOtherEquations(PlantDiagnosis* plant) {
  EquationDiagnosis& carrier = plant->equations[plant->carrier];
  Finding& finding = carrier.diagnosis.finding;
  if (finding.verdict != Verdict::kAmbiguous) return;
  for (const EquationDiagnosis& asked : plant->equations) {
    if (&asked == &carrier || HasGap(asked) || !asked.suitability.can_name) continue;
    for (const CandidatePtr& candidate : std::vector<CandidatePtr>(finding.set)) {
      const Fitted& fit = candidate->fit;
      if (fit.hypothesis.terms.size() != 1 || fit.hypothesis.terms[0].when.kind != When::Kind::kAlways) continue;
      const EffectForm& form = *fit.hypothesis.terms[0].form;
      std::vector<double> values;
      values.reserve(static_cast<std::size_t>(form.size()));
      for (int c = 0; c < form.size(); ++c)
        values.push_back(
            form.coordinates[static_cast<std::size_t>(c)].Value(fit.theta[fit.theta.size() - form.size() + c]));
      const std::optional<double> evidence = Evidence(asked, form.effect, values);
      if (!evidence || std::abs(*evidence) < kDecisive) continue;
      if (*evidence > 0.0)
        finding.set = {candidate};
      else
        std::erase(finding.set, candidate);
      Weigh(candidate, *evidence, &finding);
      char note[200];
      std::snprintf(note, sizeof(note), "%s: %s %s by %.0f nats, with the parameters fitted to the %s",
                    asked.equation->name().c_str(), *evidence > 0.0 ? "confirms" : "rejects", form.effect.c_str(),
                    std::abs(*evidence), carrier.equation->name().c_str());
      plant->notes.emplace_back(note);
    }
  }
  if (finding.set.empty()) {
    finding.verdict = Verdict::kUnnamed;
    return;
  }
  finding.best = finding.set.front();
  if (finding.set.size() == 1) finding.verdict = Verdict::kNamed;
}

/// If several equations have a gap and can name the same effects, only effects named in all of them are missing.
void KeepShared(PlantDiagnosis* plant) {
  EquationDiagnosis& carrier = plant->equations[plant->carrier];
  Finding& finding = carrier.diagnosis.finding;
  for (EquationDiagnosis& other : plant->equations) {
    if (&other == &carrier || other.diagnosis.finding.set.empty()) continue;
    std::vector<CandidatePtr> shared;
    for (const CandidatePtr& mine : finding.set)
      if (std::any_of(other.diagnosis.finding.set.begin(), other.diagnosis.finding.set.end(),
                      [&](const CandidatePtr& theirs) { return theirs->names() == mine->names(); }))
        shared.push_back(mine);
    if (shared.empty()) continue;
    // An effect that only one equation allows is not missing in both.
    double lost = 0.0;
    for (const CandidatePtr& mine : finding.set) {
      if (std::find(shared.begin(), shared.end(), mine) != shared.end()) continue;
      lost += mine->probability;
      mine->probability = 0.0;
    }
    for (const CandidatePtr& kept : shared) kept->probability += lost / static_cast<double>(shared.size());
    finding.set = shared;
    finding.best = shared.front();
    finding.verdict = shared.size() == 1 ? Verdict::kNamed : Verdict::kAmbiguous;
    plant->notes.push_back(other.equation->name() + ": also has a gap, which the same effect explains");
    other.diagnosis.finding.verdict = Verdict::kNone;
    other.diagnosis.finding.set.clear();
  }
}

/// The equation in which an effect is named, else the one with the larger gap, else one that these data can judge.
std::size_t CarrierOf(const std::vector<EquationDiagnosis>& equations) {
  std::size_t best = 0;
  std::array<double, 3> most{-1.0};
  for (std::size_t i = 0; i < equations.size(); ++i) {
    const EquationDiagnosis& one = equations[i];
    const Finding& finding = one.diagnosis.finding;
    // A gap that stays unnamed, such as that of a law that errs, must not hide an effect that is named elsewhere.
    const std::array<double, 3> rank = {finding.set.empty() ? 0.0 : 1.0, HasGap(one) ? 1.0 + finding.gap : 0.0,
                                        one.suitability.can_name ? 1.0 : 0.0};
    if (rank > most) {
      most = rank;
      best = i;
    }
  }
  return best;
}

/// Of the effects that the model has, those of one equation; they are taken out of `nowhere`.
std::vector<std::pair<std::string, When>> KnownTo(const std::vector<EffectForm>& catalogue,
                                                  const std::vector<std::pair<std::string, When>>& known,
                                                  std::vector<std::pair<std::string, When>>* nowhere) {
  std::vector<std::pair<std::string, When>> own;
  for (const auto& one : known) {
    const auto is_it = [&](const EffectForm& form) { return form.exact() && form.effect == one.first; };
    if (std::none_of(catalogue.begin(), catalogue.end(), is_it)) continue;
    own.push_back(one);
    std::erase_if(*nowhere, [&](const auto& other) { return other.first == one.first; });
  }
  return own;
}

}  // namespace

std::vector<const EquationDiagnosis*> PlantDiagnosis::Others() const {
  std::vector<const EquationDiagnosis*> others;
  for (std::size_t i = 0; i < equations.size(); ++i)
    if (i != carrier && HasGap(equations[i])) others.push_back(&equations[i]);
  return others;
}

PlantDiagnosis DiagnosePlant(const std::string& model, const Recording& recording, const DiagnoseOptions& options) {
  constexpr int kWindow = 15;
  PlantDiagnosis plant;
  std::vector<std::pair<std::string, When>> nowhere = options.known;
  for (std::unique_ptr<Equation>& equation : MakeEquations(model)) {
    EquationDiagnosis one;
    const Signals signals = equation->Prepare(recording, kWindow);
    one.suitability = equation->Check(signals);
    DiagnoseOptions own = options;
    own.known = KnownTo(equation->Catalogue(signals), options.known, &nowhere);
    one.diagnosis =
        one.suitability.can_name ? Diagnose(*equation, recording, own) : CompareOnly(*equation, recording, own);
    if (!one.suitability.note.empty()) plant.notes.push_back(one.suitability.note);
    one.equation = std::move(equation);
    plant.equations.push_back(std::move(one));
  }
  if (!nowhere.empty())
    throw std::invalid_argument("the workflow knows no effect of " + model + " called " + nowhere.front().first);
  plant.carrier = CarrierOf(plant.equations);
  ResolveByOtherEquations(&plant);
  KeepShared(&plant);
  return plant;
}

}  // namespace armcmc::gap
