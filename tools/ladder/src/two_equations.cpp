#include "two_equations.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/ladder/equations.hpp"
#include "armcmc/plant/error.hpp"
#include "armcmc/support/plant_effects.hpp"
#include "comparison.hpp"
#include "held_out.hpp"
#include "one_equation.hpp"
#include "rung.hpp"

namespace armcmc::ladder {
namespace {

using gap::Verdict;

constexpr const char* kLaw = "law";

/// One of the two equations, as a plant of its own, with its diagnosis.
struct Equation {
  support::PlantFile file;
  DiagnosisRequest request;
  Dataset data;
  Diagnosis diagnosis;

  [[nodiscard]] const Ladder& ladder() const { return diagnosis.ladder; }
  [[nodiscard]] const gap::Result& result() const { return diagnosis.result; }
  [[nodiscard]] bool HasGap() const { return result().verdict != Verdict::kNone; }
  [[nodiscard]] bool Names() const { return !result().ladder.empty(); }
};

std::unique_ptr<Equation> MakeEquation(const DiagnosisRequest& whole, const PlantDescription& plant, std::string name) {
  auto equation = std::make_unique<Equation>(Equation{{plant, Plant(plant), whole.plant->effects}, whole, {}, {}});
  equation->request.plant = &equation->file;
  equation->request.equation = std::move(name);
  return equation;
}

void DiagnosePart(Equation* equation, double from, double to) {
  const auto progress = equation->request.progress;
  equation->request.progress = PartOf(progress, from, to);
  equation->diagnosis = DiagnoseEquation(equation->request, &equation->data);
  equation->request.progress = progress;
}

/// Parameters of a model: values of the fits in `known` for those with the same names, the centre of the prior for the
/// others.
Eigen::VectorXd ValuesFrom(const identify::TrajectoryModel& model, const std::vector<const Trial*>& known) {
  Eigen::VectorXd theta = model.Start();
  for (const Trial* trial : known)
    for (std::size_t d = 0; d < model.parameters().size(); ++d)
      for (std::size_t k = 0; k < trial->model->parameters().size(); ++k)
        if (model.parameters()[d].name == trial->model->parameters()[k].name)
          theta[static_cast<Eigen::Index>(d)] = trial->fit.theta[static_cast<Eigen::Index>(k)];
  return theta;
}

double TrainingError(const identify::TrajectoryModel& model, const Dataset& data, const Eigen::VectorXd& prediction) {
  double sum = 0.0, count = 0.0;
  for (std::size_t n = 0; n < data.training.size(); ++n) {
    if (data.training[n] == 0 || model.active()[n] == 0) continue;
    const auto at = static_cast<Eigen::Index>(n);
    sum += std::pow(model.target()[at] - prediction[at], 2);
    count += 1.0;
  }
  return std::sqrt(sum / std::max(count, 1.0));
}

/// The prediction of the output as a plant; empty if it has nothing to fit.
///
/// A state that starts at a measured signal is replaced by that signal, unless the simulated state, with the parameters
/// fitted to the law, predicts the output clearly better. In that case the signal is only its initial value: a body may
/// start at room temperature without following it.
std::optional<PlantDescription> PredictionOf(const DiagnosisRequest& whole, const Trial& law) {
  constexpr double kClearly = 0.8;  // ratio of the rms errors
  const PlantDescription& plant = whole.plant->plant.description();
  Dataset data = DatasetOf(whole.recording);
  const auto output = static_cast<std::size_t>(whole.plant->plant.output());
  const std::vector<double>& y = data.series->signals[output];
  const double noise =
      NoiseFloor(data, Eigen::Map<const Eigen::VectorXd>(y.data(), static_cast<Eigen::Index>(y.size())),
                 std::vector<std::uint8_t>(y.size(), 1));
  const DataScales scales = ScalesOf(data, plant, noise);
  const std::vector<MeasuredState> measured = MeasuredStates(plant);
  std::optional<PlantDescription> by_signals = OutputEquation(plant, measured, scales, noise);
  if (measured.empty()) return by_signals;
  std::optional<PlantDescription> simulated = OutputEquation(plant, {}, scales, noise);
  if (!by_signals || !simulated) return by_signals ? by_signals : simulated;
  const Trial fitted = FitAlone(std::make_shared<const Plant>(*by_signals), &data);
  const identify::TrajectoryModel model(std::make_shared<const Plant>(*simulated), data.series);
  Eigen::VectorXd prediction;
  if (!model.PredictOne(ValuesFrom(model, {&fitted, &law}), &prediction)) return by_signals;
  if (!fitted.fit.valid) return simulated;
  return TrainingError(model, data, prediction) < kClearly * fitted.fit.error_sd ? simulated : by_signals;
}

/// A prediction whose error exceeds the variation of the output has wrong constants or units. Any effect that deforms
/// it strongly, such as a saturation, would then seem to explain the output, so no effect may be named in it.
/// @return a note that says so; empty if the prediction is good enough to be diagnosed.
std::string ReasonNotDiagnosable(const Equation& prediction) {
  Dataset data = DatasetOf(prediction.request.recording);
  const Trial trial = FitAlone(std::make_shared<const Plant>(prediction.file.plant.description()), &data);
  if (!trial.fit.valid) return {};
  double count = 0.0, sum = 0.0, squares = 0.0, both = 0.0, of_prediction = 0.0;
  for (std::size_t n = 0; n < data.training.size(); ++n) {
    if (data.training[n] == 0 || trial.model->active()[n] == 0) continue;
    const double y = trial.model->target()[static_cast<Eigen::Index>(n)];
    const double predicted = trial.fit.prediction[static_cast<Eigen::Index>(n)];
    count += 1.0;
    sum += y;
    squares += y * y;
    both += y * predicted;
    of_prediction += predicted * predicted;
  }
  const double variance = squares / count - sum / count * (sum / count);
  if (!(trial.fit.error_sd * trial.fit.error_sd > variance)) return {};
  char text[200];
  std::snprintf(
      text, sizeof(text),
      ": its error exceeds the variation of the output, so no effect is named in it. Multiplied by %.3g it would fit "
      "best: check the constants and their units",
      both / std::max(of_prediction, 1e-300));
  return prediction.request.equation + text;
}

/// Makes `named`, which are contenders of the first rung, the only effects that the ladder names; later rungs are
/// dropped.
void NameOnly(std::vector<std::size_t> named, Equation* equation) {
  Ladder& ladder = equation->diagnosis.ladder;
  Rung& rung = ladder.rungs.front();
  rung.named = std::move(named);
  rung.probability = std::max(rung.probability, rung.leader().gain_share);
  rung.open = false;
  ladder.rungs.resize(1);
  ladder.plant = rung.leader().candidate.plant;
  ladder.final_trial = rung.leader().trial;
  ladder.view = rung.view;
  ladder.flexible_gain = FlexibleGain(ladder.view, ladder.final_trial);
  ladder.complete = !LeavesMore(ladder.view, ladder.final_trial, ladder.noise_floor);
  Tell(equation->request, equation->data, &equation->diagnosis);
}

/// Effects that the first rung names. If one of them is an error of a sensor, also other sensor errors that fit equally
/// well: an offset of the output and an offset of an input of the states may be indistinguishable in this equation.
std::vector<std::size_t> NamedOrEquivalent(const Ladder& ladder) {
  constexpr double kAlike = 1.02;  // ratio of the squared errors
  const Rung& rung = ladder.rungs.front();
  std::vector<std::size_t> named = rung.named;
  if (named.empty()) return named;
  const auto slot = [](const Contender& c) { return c.candidate.form().terms.front().slot; };
  std::set<std::string> families;
  bool of_sensor = false;
  for (const std::size_t i : named) {
    const Contender& c = rung.contenders[i];
    families.insert(c.candidate.entry->family);
    of_sensor = of_sensor || slot(c) == "input" || slot(c) == "output";
  }
  for (std::size_t i = 0; i < rung.contenders.size() && of_sensor; ++i) {
    const Contender& c = rung.contenders[i];
    if (!c.trial.judged || !c.has_evidence || c.ruled_out || c.ruled_out_with ||
        (slot(c) != "input" && slot(c) != "output"))
      continue;
    if (c.alone.folds > kAlike * rung.leader().alone.folds) continue;
    if (c.candidate.form().parameters.size() > rung.leader().candidate.form().parameters.size()) continue;
    if (families.insert(c.candidate.entry->family).second) named.push_back(i);
  }
  return named;
}

bool SameEffect(const Candidate& a, const Candidate& b) {
  return a.entry->name == b.entry->name && a.form().terms.front().slot == b.form().terms.front().slot &&
         a.binding.symbols == b.binding.symbols;
}

/// The plant with the parameters from index `first` on as constants, at the values of a fit.
PlantDescription WithValues(PlantDescription plant, const Trial& trial, std::size_t first) {
  std::vector<ParameterDescription> added(plant.parameters.begin() + static_cast<std::ptrdiff_t>(first),
                                          plant.parameters.end());
  plant.parameters.resize(first);
  for (const ParameterDescription& p : added)
    for (std::size_t d = 0; d < trial.model->parameters().size(); ++d)
      if (trial.model->parameters()[d].name == p.name) {
        const auto at = static_cast<Eigen::Index>(d);
        plant.constants.push_back({p.name, trial.model->Shown(at, trial.fit.theta[at]), p.unit});
      }
  return plant;
}

/// Log-likelihood ratio, in nats, of the presence of an effect with the parameters fitted in another equation. Errors
/// of neighbouring samples are correlated: kTogether samples count as one. Empty if the effect cannot act in this
/// equation.
std::optional<double> Evidence(const Equation& asked, const Contender& found) {
  constexpr double kTogether = 5.0;
  const Trial& base = asked.ladder().base;
  const PlantDescription plant = base.model->plant().description();
  try {
    const DataScales scales = ScalesOf(asked.ladder().view.data, plant, asked.ladder().noise_floor);
    PlantDescription with = AddEffect(plant, *found.candidate.entry, found.candidate.binding, scales);
    with = WithValues(std::move(with), found.trial, plant.parameters.size());
    const Dataset& data = asked.ladder().view.data;
    const Trial trial = Refine(std::make_shared<const Plant>(with), data, base.fit.theta);
    if (!trial.fit.valid) return std::nullopt;
    const auto rows = static_cast<double>(data.num_training());
    return rows / kTogether * std::log(base.fit.error_sd / trial.fit.error_sd);
  } catch (const PlantError&) {  // it cannot be attached to this equation
    return std::nullopt;
  }
}

std::string Names(const Equation& equation, const std::vector<std::size_t>& which) {
  std::string text;
  for (const std::size_t i : which) {
    if (!text.empty()) text += " or ";
    text += equation.ladder().rungs.front().contenders[i].candidate.entry->name;
  }
  return text;
}

/// Decides a tie with the other equation, which has no gap: it confirms or rejects each effect by its likelihood ratio.
void ResolveByOtherEquations(const Equation& asked, Equation* carrier, std::vector<std::string>* notes) {
  constexpr double kDecisive = 5.0;  // nats
  std::vector<std::size_t> open = NamedOrEquivalent(carrier->ladder());
  if (open.size() < 2) return;
  const std::size_t before = open.size();
  for (const std::size_t i : std::vector<std::size_t>(open)) {
    const Contender& c = carrier->ladder().rungs.front().contenders[i];
    const std::optional<double> evidence = Evidence(asked, c);
    if (!evidence || std::abs(*evidence) < kDecisive) continue;
    char text[200];
    std::snprintf(text, sizeof(text), "%s: %s %s by %.0f nats, with the parameters fitted to the %s",
                  asked.request.equation.c_str(), *evidence > 0.0 ? "confirms" : "rejects",
                  c.candidate.entry->name.c_str(), std::abs(*evidence), carrier->request.equation.c_str());
    notes->emplace_back(text);
    if (*evidence > 0.0) {
      open = {i};
      break;
    }
    std::erase(open, i);
  }
  if (open.empty()) return;
  if (open.size() != before || open.size() != carrier->ladder().rungs.front().named.size())
    NameOnly(std::move(open), carrier);
}

/// If both equations have a gap and the same effect on a signal explains both, only that effect is named.
/// @return whether there is such an effect.
bool KeepShared(const Equation& other, Equation* carrier, std::vector<std::string>* notes) {
  if (!other.Names() || !carrier->Names()) return false;
  const std::vector<std::size_t> mine = NamedOrEquivalent(carrier->ladder()),
                                 theirs = NamedOrEquivalent(other.ladder());
  std::vector<std::size_t> shared;
  for (const std::size_t i : mine)
    for (const std::size_t k : theirs)
      if (SameEffect(carrier->ladder().rungs.front().contenders[i].candidate,
                     other.ladder().rungs.front().contenders[k].candidate))
        shared.push_back(i);
  if (shared.empty()) return false;
  notes->push_back(other.request.equation + ": also has a gap, which " + Names(*carrier, shared) + " explains");
  if (shared != carrier->ladder().rungs.front().named) NameOnly(std::move(shared), carrier);
  return true;
}

/// Rank by which the equation that the result describes is chosen: the verdict first, then the size of the gap.
double RankOf(const Equation& equation) {
  if (!equation.HasGap()) return 0.0;
  const gap::Result& result = equation.result();
  const double ratio = result.gap.gap_ratio, by_gap = ratio / (1.0 + ratio);
  return (result.verdict == Verdict::kNamed ? 3.0 : result.verdict == Verdict::kAmbiguous ? 2.0 : 1.0) + by_gap;
}

/// The whole plant with the effects that were named in one equation, and their fitted priors.
PlantDescription WithNamed(PlantDescription plant, const Equation& equation) {
  const Ladder& ladder = equation.ladder();
  const PlantDescription& found = ladder.plant->description();
  if (ladder.free_constants)
    plant = AddFreeConstants(plant, *ladder.free_constants, ScalesOf(ladder.view.data, plant, ladder.noise_floor));
  for (const Rung& rung : ladder.rungs) {
    if (rung.named.empty()) continue;
    const Candidate& named = rung.leader().candidate;
    plant = AddEffect(plant, *named.entry, named.binding, ScalesOf(rung.view.data, plant, ladder.noise_floor));
  }
  const auto same = [](auto* list, const auto& from) {
    for (auto& item : *list)
      for (const auto& other : from)
        if (item.name == other.name) item = other;
  };
  same(&plant.constants, found.constants);
  same(&plant.parameters, found.parameters);
  return plant;
}

/// Sets the models of the whole plant. Parameters of effects in the law are estimated; those of effects in the
/// prediction are constants, since the estimator learns from the law only.
void MakeModels(const DiagnosisRequest& whole, const Equation& law, const Equation* prediction, Diagnosis* out) {
  const PlantDescription plant = whole.plant->plant.description();
  const std::size_t own = plant.parameters.size();
  const std::vector<std::uint8_t>& rows = law.ladder().view.data.training;
  const bool in_prediction = prediction != nullptr && prediction->Names();
  try {
    PlantDescription with = law.Names() ? WithNamed(plant, law) : plant;
    const Trial& trial = law.Names() ? law.ladder().final_trial : law.ladder().base;
    const std::size_t of_law = with.parameters.size();
    if (in_prediction) {
      with = WithNamed(std::move(with), *prediction);
      with = WithValues(std::move(with), prediction->ladder().final_trial, of_law);
    }
    TunedPlant after = Tuned(with, own, trial, rows);
    (void)Plant(after.plant);
    out->before = Tuned(plant, own, law.ladder().base, rows);
    out->after = std::move(after);
    if (in_prediction)
      out->result.notes.emplace_back(
          "the effect in the prediction has constant parameters in the new model: the estimator learns from the law "
          "only");
  } catch (const PlantError& error) {
    out->result.notes.push_back(std::string("the new model contains the effects of one equation only: ") +
                                error.what());
  }
}

/// Adds the result of the other equation: its effects if both are named, otherwise its sentence as a note.
void AddOther(const Equation& other, Equation* carrier) {
  gap::Result& result = carrier->diagnosis.result;
  if (!other.HasGap()) return;
  if (other.result().verdict == Verdict::kNamed && result.verdict == Verdict::kNamed) {
    result.effects.insert(result.effects.end(), other.result().effects.begin(), other.result().effects.end());
    result.sentence += " " + other.result().sentence;
    result.complete = result.complete && other.result().complete;
  } else {
    result.notes.push_back(other.result().sentence);
    result.complete = false;
  }
}

}  // namespace

Diagnosis DiagnoseBoth(const DiagnosisRequest& request) {
  constexpr double kEach = 0.45;  // estimated share of the time for each equation
  const PlantDescription& plant = request.plant->plant.description();
  std::vector<std::unique_ptr<Equation>> equations;
  equations.push_back(MakeEquation(request, LawEquation(plant), kLaw));
  Equation& law = *equations.front();
  DiagnosePart(&law, 0.0, kEach);
  std::vector<std::string> notes;
  if (const std::optional<PlantDescription> prediction = PredictionOf(request, law.ladder().base)) {
    equations.push_back(MakeEquation(request, *prediction, "prediction of " + plant.output));
    Equation& last = *equations.back();
    if (const std::string far_off = ReasonNotDiagnosable(last); !far_off.empty()) {
      notes.push_back(far_off);
      for (const EffectEntry& entry : support::EffectsFor(last.file.effects))
        last.request.without.push_back(entry.name);
    }
    DiagnosePart(&last, kEach, 2.0 * kEach);
  } else {
    notes.push_back("prediction of " + plant.output + ": not diagnosed, since it has no parameter and no state");
  }
  const auto chosen = std::max_element(equations.begin(), equations.end(),
                                       [](const auto& a, const auto& b) { return RankOf(*a) < RankOf(*b); });
  Equation* const prediction = equations.size() > 1 ? equations.back().get() : nullptr;
  // The estimator learns from the law, so an effect in both equations is reported for the law.
  const bool shared = prediction != nullptr && KeepShared(*prediction, &law, &notes);
  Equation* const carrier = shared ? &law : chosen->get();
  Equation* const other = prediction == nullptr ? nullptr : carrier == prediction ? &law : prediction;
  if (other != nullptr && carrier->Names() && !other->HasGap()) ResolveByOtherEquations(*other, carrier, &notes);
  FollowUp(carrier->request, carrier->data, &carrier->diagnosis);
  if (carrier->Names() || (other != nullptr && other->Names()))
    MakeModels(request, law, shared ? nullptr : prediction, &carrier->diagnosis);
  if (other != nullptr && !shared) AddOther(*other, carrier);
  gap::Result& result = carrier->diagnosis.result;
  result.notes.insert(result.notes.end(), notes.begin(), notes.end());
  return std::move(carrier->diagnosis);
}

}  // namespace armcmc::ladder
