#include "armcmc/gap_bench/run.hpp"

#include <ctime>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <mutex>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <tuple>

#include "armcmc/gap/equation.hpp"
#include "armcmc/gap/workflow.hpp"
#include "armcmc/gap_bench/scenario_text.hpp"
#include "armcmc/gap_bench/score.hpp"
#include "armcmc/gap_bench/strata.hpp"
#include "armcmc/ladder/second_search.hpp"
#include "armcmc/support/shared_files.hpp"
#include "closing.hpp"
#include "contents.hpp"

namespace armcmc::gap_bench {
namespace {

/// Processor time of this thread: on a machine that others use, too, the clock on the wall tells little.
double CpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The rows of a recording that are part of it.
std::pair<Eigen::Index, Eigen::Index> RowsOf(Part part, Eigen::Index rows) {
  const Eigen::Index half = rows / 2;
  if (part == Part::kFirstHalf) return {0, half};
  if (part == Part::kSecondHalf) return {half, rows - half};
  return {0, rows};
}

/// All that the tool is given: the model, a recording, after a tie the one before it, and which effects its catalogue
/// lacks.
Answer RunDiagnosis(const std::filesystem::path& recording, const std::filesystem::path& earlier, const Case& what) {
  Answer answer;
  const double start = CpuSeconds();
  try {
    gap::WorkflowRequest request;
    request.model = what.model;
    request.data = gap::ReadRecording(recording, gap::ColumnsOf(what.model), false);
    const auto [first, count] = RowsOf(what.part, request.data.t.size());
    request.data = request.data.Slice(first, count);
    if (!earlier.empty()) request.earlier = gap::ReadRecording(earlier, gap::ColumnsOf(what.model), false);
    request.diagnose.without = what.without;
    answer.result = gap::RunWorkflow(request).result;
    if (answer.result.verdict == gap::Verdict::kUnnamed)
      if (auto beside = gap::RunBesideLawError(request)) answer.result = std::move(beside->result);
    if (answer.result.verdict == gap::Verdict::kUnnamed)
      if (auto again = ladder::SearchAgain(request)) answer.result = std::move(again->diagnosis.result);
    answer.result.figures = {};
  } catch (const std::exception& error) {
    answer.error = error.what();
  }
  answer.cpu_s = CpuSeconds() - start;
  return answer;
}

std::string ScenarioOf(const PlantProcess& plant, const Case& what) {
  const std::filesystem::path own = plant.folder() / what.scenario;
  return Contents(std::filesystem::exists(own) ? own : support::FindSharedFile("scenarios", what.scenario));
}

/// What the effects of a truth add to the outputs, [output][row], where `others` act already: what a limit takes off
/// depends on all that raises the force.
/// @param gates  Whether effects keep their gates; otherwise they act from the first sample to the last.
std::vector<std::vector<double>> Contributions(const PlantProcess& plant, const Case& what, const Truth& truth,
                                               const Truth& others, bool gates) {
  const std::string scenario = WithoutTables(ScenarioOf(plant, what), "hidden_effect");
  std::vector<std::vector<double>> with = plant.Outputs(what, scenario + EffectTables(truth, gates));
  const std::vector<std::vector<double>> base = plant.Outputs(what, scenario + EffectTables(others, gates));
  for (std::size_t k = 0; k < with.size(); ++k)
    for (std::size_t i = 0; i < with[k].size(); ++i) with[k][i] -= base[k][i];
  return with;
}

/// The truth with only those of its effects that an answer names.
Truth Found(const Truth& truth, const Names& answer) {
  Truth found = truth;
  std::erase_if(found.effects, [&](const TrueEffect& effect) {
    return std::find(answer.begin(), answer.end(), effect.name) == answer.end();
  });
  return found;
}

/// Of what the effects add to those that were found.
double StrengthGiven(const PlantProcess& plant, const Case& what, const Truth& truth, const Truth& found) {
  constexpr double kDiagnosed = 0.7;  // of the recording
  const std::vector<std::vector<double>> outputs = Contributions(plant, what, truth, found, true);
  double strength = 0.0;
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const std::vector<double>& added = outputs[k];
    const auto [first, count] = RowsOf(what.part, static_cast<Eigen::Index>(added.size()));
    const auto rows = static_cast<std::ptrdiff_t>(kDiagnosed * static_cast<double>(count));
    const auto begin = added.begin() + first;
    const double squares = std::inner_product(begin, begin + rows, begin, 0.0);
    const double rms = std::sqrt(squares / static_cast<double>(std::max<std::ptrdiff_t>(rows, 1)));
    strength = std::max(strength, rms / truth.noise_sd[k]);
  }
  return strength;
}

/// Of what was not found, given the answer that lacks most.
double DiagnosedStrength(const PlantProcess& plant, const Outcome& outcome) {
  std::vector<Names> answers = SetsOf(outcome.answer.result);
  if (answers.empty()) answers.emplace_back();
  double strength = 0.0;
  for (const Names& answer : answers)
    strength = std::max(strength, StrengthGiven(plant, outcome.what, outcome.truth, Found(outcome.truth, answer)));
  return strength;
}

/// Tables of noise whose correlation over a time stays when it is sampled `ratio` times the interval apart.
std::string Resampled(const std::string& tables, double ratio) {
  const std::string key = "correlation = ";
  std::istringstream lines(tables);
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(key)) {
      char number[32];
      std::snprintf(number, sizeof(number), "%.17g", std::pow(std::stod(line.substr(key.size())), ratio));
      line = key + number;
    }
    text += line + '\n';
  }
  return text;
}

void Score(const PlantProcess& plant, Outcome* outcome) {
  const gap::Result& result = outcome->answer.result;
  outcome->grade = GradeOf(outcome->what, outcome->truth, result);
  std::tie(outcome->label, outcome->label_probability) = TopLabel(result);
  if (!std::isfinite(outcome->label_probability))
    throw std::runtime_error("the probability of " + outcome->label + " is not a number");
  if (Imperfect(outcome->what.stratum) && outcome->truth.effects.empty())
    outcome->model_error = ModelError(plant, *outcome, ScenarioOf(plant, outcome->what));
  outcome->label_right = LabelRight(outcome->what, outcome->truth, outcome->label, outcome->model_error.value_or(0.0));
  if (outcome->grade == Grade::kNone || outcome->grade == Grade::kPartial) {
    outcome->diagnosed_strength = DiagnosedStrength(plant, *outcome);
    if (*outcome->diagnosed_strength < kTrace) outcome->grade = Grade::kNotShown;
  }
  if (Imperfect(outcome->what.stratum))
    outcome->first_rung = FirstRung(plant, *outcome, ScenarioOf(plant, outcome->what));
  outcome->equation_right = EquationRight(outcome->truth, result);
  if (outcome->truth.effects.size() != 1) return;
  const TrueEffect& effect = outcome->truth.effects.front();
  if (effect.onset_s && !result.effects.empty()) {
    outcome->onset_error_s = OnsetError(result, effect.name,
                                        OnsetInterval(Contributions(plant, outcome->what, outcome->truth, {}, false)[0],
                                                      result.dt, *effect.onset_s, outcome->truth.noise_sd[0]));
    outcome->onset_off_s = OnsetError(result, effect.name, {*effect.onset_s, *effect.onset_s});
  }
  const bool contact = effect.gate == "contact";
  if ((contact || effect.gate == "free") && !result.effects.empty())
    outcome->when_right =
        result.effects.front().when.kind == (contact ? gap::When::Kind::kContact : gap::When::Kind::kFree);
}

}  // namespace

Outcome RunCase(const PlantProcess& plant, const Case& what, bool keep) {
  Outcome outcome;
  outcome.what = what;
  try {
    if (!plant.Make(what) || (what.earlier && !plant.Make(*what.earlier))) return outcome;
    outcome.grade = Grade::kFailed;
    outcome.answer = RunDiagnosis(plant.Recording(what), what.earlier ? plant.Recording(*what.earlier) : "", what);
    outcome.truth = ReadSealed(plant.Sealed(what), what.model);
    if (outcome.answer.error.empty()) Score(plant, &outcome);
  } catch (const std::exception& error) {
    outcome.grade = Grade::kFailed;
    outcome.answer.error = error.what();
  }
  if (!keep) plant.Remove(what);
  if (!keep && what.earlier) plant.Remove(*what.earlier);
  return outcome;
}

std::vector<Outcome> RunCases(const PlantProcess& plant, const std::vector<Case>& cases, int jobs, bool keep,
                              const std::function<void(const Outcome&)>& done) {
  std::vector<Outcome> outcomes(cases.size());
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  const auto work = [&] {
    for (std::size_t i = next++; i < cases.size(); i = next++) {
      outcomes[i] = RunCase(plant, cases[i], keep);
      const std::lock_guard lock(mutex);
      if (done) done(outcomes[i]);
    }
  };
  std::vector<std::jthread> threads;
  for (int j = 1; j < jobs; ++j) threads.emplace_back(work);
  work();
  threads.clear();
  return outcomes;
}

bool CanFollowUp(const Outcome& outcome) {
  const std::vector<TrueEffect>& effects = outcome.truth.effects;
  // The experiment is made with the catalogue's plant.
  if (Imperfect(outcome.what.stratum)) return false;
  return outcome.grade == Grade::kTie && std::all_of(effects.begin(), effects.end(), [](const TrueEffect& effect) {
           return effect.kind == "catalogue";
         });
}

Case FollowUp(const PlantProcess& plant, const Outcome& outcome) {
  Case next = outcome.what;
  next.stratum = "ties";
  next.group = outcome.what.stratum;
  next.effect.clear();
  next.gate.clear();
  std::string parameters;
  for (const auto& [name, value] : outcome.truth.base_parameters) {
    char line[64];
    std::snprintf(line, sizeof(line), "%s = %.17g\n", name.c_str(), value);
    parameters += line;
  }
  std::string text = WithTable(outcome.answer.result.separate_by.scenario_text, "parameters", parameters);
  text = WithoutTables(text, "noise.") +
         Resampled(outcome.truth.noise_tables,
                   outcome.answer.result.separate_by.sample_interval_s / outcome.answer.result.dt);
  // What began during the first recording goes on in the second.
  Truth truth = outcome.truth;
  for (TrueEffect& effect : truth.effects)
    if (effect.onset_s) effect.gate = "always";
  text += EffectTables(truth, true);
  std::filesystem::create_directories(plant.folder() / "scenarios");
  next.scenario = "scenarios/experiment_" + outcome.what.Name() + ".toml";
  std::ofstream(plant.folder() / next.scenario, std::ios::binary) << text;
  ++next.seed;  // another day, other noise
  next.earlier = std::make_shared<const Case>(outcome.what);
  return next;
}

}  // namespace armcmc::gap_bench
