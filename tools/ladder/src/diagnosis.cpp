#include "armcmc/ladder/diagnosis.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/ladder/drift.hpp"
#include "armcmc/support/plant_effects.hpp"
#include "armcmc/support/program.hpp"
#include "free_starts.hpp"
#include "held_out.hpp"
#include "one_equation.hpp"
#include "run_along.hpp"
#include "two_equations.hpp"

namespace armcmc::ladder {

Diagnosis DiagnoseEquation(const DiagnosisRequest& request, Dataset* data) {
  Diagnosis diagnosis;
  *data = DatasetOf(request.recording);
  if (data->num_training() < 100)
    throw support::InputError(request.recording.title + ": a diagnosis needs at least 100 rows to fit to, there are " +
                              std::to_string(data->num_training()));
  ClimbRequest climb;
  climb.plant = std::make_shared<const Plant>(request.plant->plant.description());
  for (EffectEntry& entry : support::EffectsFor(request.plant->effects)) {
    const auto named = [&](const std::vector<std::string>& names) {
      return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
        return name == entry.name || std::find(entry.aliases.begin(), entry.aliases.end(), name) != entry.aliases.end();
      });
    };
    if (!named(request.without) && !named(request.plant->effects.without)) climb.entries.push_back(std::move(entry));
  }
  climb.data = *data;
  climb.known_noise = request.recording.smoothed_noise;
  climb.noise_over_differences = request.recording.noise_kept / request.recording.noise_told;
  // The rows on which the law was judged are judged here as well: a load may come late.
  constexpr std::size_t kSecond = 16'000;
  if (!request.equation.empty()) climb.most_simulated = kSecond;
  climb.progress = request.progress;
  diagnosis.ladder = Climb(climb);
  const Ladder& ladder = diagnosis.ladder;
  if (!ladder.base.fit.valid)
    throw support::InputError(request.recording.title + ": " + JoinedWords(ladder.notes, "; "));
  LeaveOutStarts(ladder.base, data);
  Tell(request, *data, &diagnosis);
  return diagnosis;
}

void FollowUp(const DiagnosisRequest& request, const Dataset& data, Diagnosis* diagnosis) {
  const Ladder& ladder = diagnosis->ladder;
  const PlantDescription& plant = request.plant->plant.description();
  const std::size_t own = plant.parameters.size();
  diagnosis->before = Tuned(plant, own, ladder.base, ladder.view.data.training);
  diagnosis->after =
      Tuned(WithOwnStarts(ladder.plant->description(), plant), own, ladder.final_trial, ladder.view.data.training);
  const bool named = NumNamed(ladder) > 0;
  if (named && !diagnosis->after.held.empty())
    diagnosis->result.notes.push_back(
        "constants in the new model, since these data do not tell them, they lie on a bound, or the estimator "
        "samples no more: " +
        JoinedWords(diagnosis->after.held, ", "));
  const auto seconds = [](auto since) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
  };
  const auto run_begin = std::chrono::steady_clock::now();
  diagnosis->result.seed = request.seed;
  diagnosis->result.drift =
      DriftOver(data, diagnosis->before, ladder.base, named ? &diagnosis->after : nullptr, ladder.final_trial);
  const auto drift_end = std::chrono::steady_clock::now();
  diagnosis->result.run = RunAlong(std::make_shared<const support::Recording>(request.recording), diagnosis->before,
                                   named ? &diagnosis->after : nullptr, request.seed, [&](double share) {
                                     if (request.progress) request.progress("run", share);
                                   });
  diagnosis->result.seconds.emplace_back("one step", seconds(drift_end));
  diagnosis->result.seconds.emplace_back("drift", std::chrono::duration<double>(drift_end - run_begin).count());
}

Diagnosis Diagnose(const DiagnosisRequest& request) {
  constexpr double kClimb = 0.9;  // estimated fraction of the time
  const auto begin = std::chrono::steady_clock::now();
  Diagnosis diagnosis;
  if (request.plant->plant.description().predicts.empty()) {
    Dataset data;
    DiagnosisRequest part = request;
    part.progress = PartOf(request.progress, 0.0, kClimb);
    diagnosis = DiagnoseEquation(part, &data);
    part.progress = PartOf(request.progress, kClimb, 1.0);
    FollowUp(part, data, &diagnosis);
  } else {
    diagnosis = DiagnoseBoth(request);
  }
  diagnosis.result.seconds.emplace_back(
      "all", std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  return diagnosis;
}

std::function<void(const std::string&, double)> PartOf(
    const std::function<void(const std::string& step, double share)>& progress, double from, double to) {
  if (!progress) return {};
  return [progress, from, to](const std::string& step, double share) { progress(step, from + (to - from) * share); };
}

}  // namespace armcmc::ladder
