#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "armcmc/gap/equation.hpp"
#include "armcmc/gap/report.hpp"
#include "armcmc/gap/result_json.hpp"
#include "armcmc/gap/workflow.hpp"
#include "armcmc/ladder/diagnosis.hpp"
#include "armcmc/ladder/second_search.hpp"
#include "armcmc/models/registry.hpp"
#include "armcmc/support/effect_library.hpp"
#include "armcmc/support/model_file.hpp"
#include "armcmc/support/pack_length.hpp"
#include "armcmc/support/plant_library.hpp"
#include "armcmc/support/plant_writer.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/progress.hpp"
#include "armcmc/support/sha256.hpp"
#include "armcmc/support/strict_toml.hpp"
#include "budget.hpp"
#include "followed_drift.hpp"
#include "gallery_page.hpp"
#include "printed.hpp"

namespace armcmc::gap {
namespace {

struct Arguments {
  std::string model = DefaultModel(), data, recording, data_dir, heldout, earlier, out, gallery, steps = "show";
  std::vector<std::string> without;
  std::uint64_t seed = 1;
  double period_ms = 100.0;
  bool skip_bad = false, no_pairs = false;
};

void Declare(CLI::App* app, Arguments* a) {
  auto* model = app->add_option("--model", a->model,
                                "Plant file, or name of a bundled plant; or a model file (.toml) with effects found "
                                "earlier")
                    ->type_name("FILE")
                    ->capture_default_str();
  auto* data =
      app->add_option("--data", a->data, "CSV of samples: t and the signals of the plant (see armcmc-model check)")
          ->type_name("FILE");
  auto* recording = app->add_option("--recording", a->recording,
                                    "Recording file: names the plant, and maps the columns of a CSV to its signals")
                        ->type_name("FILE")
                        ->excludes(data)
                        ->excludes(model);
  app->add_option("--data-dir", a->data_dir, "Folder of the recording's CSV, if not that of the recording file")
      ->type_name("DIR")
      ->needs(recording);
  app->add_option("--heldout", a->heldout, "Holdout: CSV of another run; default: the last 30 % of --data")
      ->type_name("FILE");
  app->add_option("--earlier", a->earlier,
                  "CSV, or recording file, of an earlier run with the same effect: ties that it left are decided with "
                  "both runs")
      ->type_name("FILE");
  app->add_option("--out", a->out, "Folder for result.json, report.html and model.toml")->type_name("DIR REQUIRED");
  app->add_option("--gallery", a->gallery,
                  "Only write index.html, a page that links the reports in the subfolders of this folder")
      ->type_name("DIR")
      ->excludes(data)
      ->excludes(recording);
  app->add_option("--seed", a->seed, "Seed of the bootstrap: the same seed gives the same result")
      ->type_name("N")
      ->capture_default_str();
  app->add_option("--steps", a->steps,
                  "Steps to run, comma separated; the last one counts: compare, find, name, add, show")
      ->type_name("LIST")
      ->capture_default_str();
  app->add_option("--without", a->without, "Effects to exclude from the catalogue")->type_name("NAME")->delimiter(',');
  app->add_option("--period-ms", a->period_ms, "Length of a pack, to measure the cost of the new model")
      ->type_name("MS")
      ->check(CLI::Range(1.0, 10'000.0))
      ->capture_default_str();
  app->add_flag("--skip-bad", a->skip_bad, "Count and skip bad rows of --data instead of stopping")
      ->excludes(recording);
  app->add_flag("--no-pairs", a->no_pairs, "Look for single effects only, which is faster");
  app->footer(
      "Compares a model with measured data, finds where they disagree, names the missing effect, writes a model with\n"
      "that effect, and shows on held-out data how much of the gap is closed. If the data do not decide, it says "
      "so.\n\n"
      "Example:\n"
      "  armcmc-plant --scenario contact_rich --hide-effect random --seed 5 --sealed truth.json --csv run.csv\n"
      "  armcmc-gap --model " +
      a->model +
      " --data run.csv --out gap\n"
      "  armcmc-estimator --config " +
      a->model +
      " --model gap/model.toml\n"
      "  armcmc-gap --model valve.toml --data valve.csv --out gap\n"
      "  armcmc-gap --recording tools/gap/recordings/emps_estimation.toml --data-dir data --out gaps/emps\n"
      "  armcmc-gap --gallery gaps\n"
      "If several effects remain, gap/experiment.toml is a motion that separates them. Run it, and use both runs:\n"
      "  armcmc-gap --model " +
      a->model +
      " --data experiment.csv --earlier run.csv --out gap2\n"
      "Exit status: 0 whatever the verdict, 2 bad usage or input, 1 any other failure.");
}

Step LastStep(const std::string& steps) {
  static const std::vector<std::pair<std::string, Step>> known = {{"compare", Step::kCompare},
                                                                  {"find", Step::kFind},
                                                                  {"name", Step::kName},
                                                                  {"add", Step::kAdd},
                                                                  {"show", Step::kShow}};
  Step last = Step::kCompare;
  std::stringstream words(steps);
  for (std::string word; std::getline(words, word, ',');) {
    const auto it = std::find_if(known.begin(), known.end(), [&](const auto& step) { return step.first == word; });
    if (it == known.end())
      throw support::InputError("--steps: '" + word + "' is not a step; steps are compare, find, name, add, show");
    last = std::max(last, it->second);
  }
  return last;
}

/// Creates the folder for the results, and removes those of an older run, so that they cannot be mistaken for new ones.
void Claim(const std::filesystem::path& out) {
  std::error_code error;
  std::filesystem::create_directories(out, error);
  if (!std::filesystem::is_directory(out))
    throw support::InputError("--out " + out.string() + ": no folder can be made there");
  for (const char* name : {"result.json", "report.html", "model.toml", "experiment.toml"}) {
    std::filesystem::remove(out / name, error);
    if (error) throw support::InputError((out / name).string() + ": cannot be replaced: " + error.message());
  }
  const std::filesystem::path probe = out / "result.json.part";
  if (!std::ofstream(probe)) throw support::InputError("--out " + out.string() + ": cannot be written to");
  std::filesystem::remove(probe, error);
}

void Write(const std::filesystem::path& path, const std::string& text) {
  const std::filesystem::path part = path.string() + ".part";
  std::ofstream file(part, std::ios::binary);
  file << text;
  if (!file.flush()) throw support::InputError(path.string() + ": cannot be written");
  file.close();
  std::filesystem::rename(part, path);
}

void WriteExperiment(const std::filesystem::path& out, Experiment* experiment) {
  if (experiment->scenario_text.empty()) return;
  experiment->scenario_file = "experiment.toml";
  Write(out / experiment->scenario_file, experiment->scenario_text);
}

/// The effects of a model file, which the search must not find again.
std::vector<std::pair<std::string, When>> KnownEffects(const EstimatorSettings& settings) {
  std::vector<std::pair<std::string, When>> known;
  for (int e = 0; e < settings.num_effects; ++e) {
    const EffectSettings& effect = settings.effects[static_cast<std::size_t>(e)];
    When when;
    switch (effect.gate) {
      case EffectGate::kContact: when.kind = When::Kind::kContact; break;
      case EffectGate::kFree: when.kind = When::Kind::kFree; break;
      case EffectGate::kFrom: when = {When::Kind::kFrom, effect.from_s}; break;
      case EffectGate::kUntil: when = {When::Kind::kUntil, effect.until_s}; break;
      case EffectGate::kAlways: break;
    }
    known.emplace_back(effect.name, when);
  }
  return known;
}

/// Rejects unknown names, which would otherwise have no effect.
void CheckWithout(const std::string& model, const std::vector<std::string>& without) {
  const int base = FindModel(BuiltinSettings(model).model);
  const ModelInfo& plant = *CompiledModels()[static_cast<std::size_t>(base)];
  for (const std::string& name : without) {
    if (FindEffect(plant, name) != nullptr) continue;
    std::string there;
    for (const EffectInfo* effect : plant.compiled->effects) {
      if (!there.empty()) there += ", ";
      there += effect->name;
    }
    std::string words = "--without: no effect is called \"";
    words.append(name).append("\"; available: ").append(there);
    throw support::InputError(words);
  }
}

/// Step time of the estimator with the base model and with the named effects.
Budget DescribedBudget(const support::Recording& recording, const ladder::Diagnosis& diagnosis,
                       std::vector<std::string>* notes) {
  if (diagnosis.before.program == nullptr || diagnosis.after.program == nullptr) return {};
  replay::SourceRequest packs;
  packs.recording = std::make_shared<const support::Recording>(recording);
  packs.period = support::SuitablePackLength(recording.dt, kMaxPackSamples) * recording.dt;
  try {
    return MeasureBudget(DescribedSettings(diagnosis.before.program), DescribedSettings(diagnosis.after.program),
                         packs);
  } catch (const std::exception& error) {
    // The diagnosis is valid even if this recording contains no complete pack.
    notes->push_back(std::string("step time of the estimator not measured: ") + error.what());
    return {};
  }
}

/// Writes and prints the result of the ladder.
int Present(const Arguments& a, const support::Recording& recording, ladder::Diagnosis* diagnosis) {
  const std::filesystem::path out = a.out;
  Result& result = diagnosis->result;
  if (!result.effects.empty()) {
    result.model_file = "model.toml";
    Write(out / result.model_file,
          support::PlantFileText(diagnosis->after.plant, "Made by armcmc-gap: " + result.sentence));
    result.budget = DescribedBudget(recording, *diagnosis, &result.notes);
  }
  WriteExperiment(out, &result.separate_by);
  Write(out / "result.json", ToJson(result).dump(2) + "\n");
  Write(out / "report.html", ReportHtml(result));
  std::cout << LadderText(result) << Summary(result);
  std::cout << "result: " << (out / "result.json").string() << '\n'
            << "report: " << (out / "report.html").string() << '\n';
  if (!result.model_file.empty()) std::cout << "model:  " << (out / result.model_file).string() << '\n';
  return support::kExitOk;
}

/// A plant with compiled code.
int RunBuiltIn(const Arguments& a) {
  WorkflowRequest request;
  request.until = LastStep(a.steps);
  request.model = support::BaseModel(a.model);
  request.diagnose.seed = a.seed;
  CheckWithout(request.model, a.without);
  request.diagnose.without = a.without;
  request.diagnose.pairs = !a.no_pairs;
  request.diagnose.known = KnownEffects(support::ReadModel(a.model));
  const std::vector<std::string> columns = ColumnsOf(request.model);
  request.data = ReadRecording(a.data, columns, a.skip_bad);
  if (!a.heldout.empty()) request.heldout = ReadRecording(a.heldout, columns, a.skip_bad);
  if (!a.earlier.empty()) request.earlier = ReadRecording(a.earlier, columns, a.skip_bad);
  const std::filesystem::path out = a.out;
  Claim(out);
  support::Progress progress("gap");
  request.progress = [&](const std::string&, double share) { progress.Update(share); };

  WorkflowOutcome outcome = RunWorkflow(request);
  Result& result = outcome.result;
  result.version = support::Version();
  result.data_sha256 = support::Sha256OfFile(a.data);
  replay::SourceRequest packs;
  packs.data = a.data;
  packs.period = 1e-3 * a.period_ms;
  packs.skip_bad = a.skip_bad;
  if (result.verdict == Verdict::kUnnamed) {
    try {
      AttributeToDrift(FollowDrift(support::ReadModel(a.model), packs), &result);
    } catch (const support::InputError& error) {
      result.notes.push_back(std::string("not tested whether it is a drift (--period-ms): ") + error.what());
    }
  }
  if (result.verdict == Verdict::kUnnamed) {
    if (auto beside = RunBesideLawError(request)) {
      beside->result.version = result.version;
      beside->result.data_sha256 = result.data_sha256;
      outcome = *std::move(beside);
    }
  }
  if (result.verdict == Verdict::kUnnamed) {
    if (auto again = ladder::SearchAgain(request)) {
      again->diagnosis.result.data_file = result.data_file;
      again->diagnosis.result.data_sha256 = result.data_sha256;
      return Present(a, again->recording, &again->diagnosis);
    }
  }
  if (outcome.augmented) {
    result.model_file = "model.toml";
    Write(out / result.model_file, support::ModelFileText(*outcome.augmented, request.model));
    try {
      result.budget = MeasureBudget(support::ReadModel(a.model), *outcome.augmented, packs);
    } catch (const support::InputError& error) {
      // The diagnosis is valid even if these samples contain no complete pack.
      result.notes.push_back(std::string("step time of the estimator not measured (--period-ms): ") + error.what());
    }
  }
  WriteExperiment(out, &result.separate_by);
  Write(out / "result.json", ToJson(result).dump(2) + "\n");
  if (request.until == Step::kShow) Write(out / "report.html", ReportHtml(result));
  if (!result.ladder.empty()) std::cout << LadderText(result);
  std::cout << Summary(result);
  std::cout << "result: " << (out / "result.json").string() << '\n';
  if (request.until == Step::kShow) std::cout << "report: " << (out / "report.html").string() << '\n';
  if (outcome.augmented) std::cout << "model:  " << (out / "model.toml").string() << '\n';
  return support::kExitOk;
}

/// Rejects options that apply to built-in plants only.
void CheckDescribed(const Arguments& a) {
  const auto refuse = [](bool given, const char* option) {
    if (given) throw support::InputError(std::string(option) + ": not for plants that a file describes; leave it out");
  };
  refuse(!a.heldout.empty(), "--heldout");
  refuse(a.no_pairs, "--no-pairs");
  refuse(LastStep(a.steps) != Step::kShow, "--steps");
}

/// A plant described by a file.
int RunDescribed(const Arguments& a) {
  CheckDescribed(a);
  ladder::DiagnosisRequest request;
  request.recording = a.recording.empty() ? support::ReadRecordedCsv(a.data, a.model, a.skip_bad)
                                          : support::ReadRecording(a.recording, a.data_dir);
  if (!a.earlier.empty()) {
    const bool described = std::filesystem::path(a.earlier).extension() == ".toml";
    request.recording =
        support::Joined(described ? support::ReadRecording(a.earlier, a.data_dir)
                                  : support::ReadRecordedCsv(a.earlier, request.recording.model, a.skip_bad),
                        request.recording);
  }
  const support::PlantFile plant = support::ReadPlantFile(support::FindPlantFile(request.recording.model));
  request.plant = &plant;
  const std::vector<EffectEntry> known = support::EffectsFor(plant.effects);
  for (const std::string& name : a.without) (void)support::FindEffect(known, name, "--without: ");
  request.without = a.without;
  request.seed = a.seed;
  const std::filesystem::path out = a.out;
  Claim(out);
  support::Progress progress("gap");
  request.progress = [&](const std::string&, double share) { progress.Update(share); };
  ladder::Diagnosis diagnosis = ladder::Diagnose(request);
  return Present(a, request.recording, &diagnosis);
}

/// Columns of a recording come and go by the thousand: giving each back to the system, to be cleared and mapped again,
/// would take a tenth of the time.
void KeepMemory() {
#ifdef __GLIBC__
  constexpr int kAlways = 1 << 30;  // bytes, beyond any column
  mallopt(M_MMAP_THRESHOLD, kAlways);
  mallopt(M_TRIM_THRESHOLD, kAlways);
#endif
}

int Run(const Arguments& a) {
  if (!a.gallery.empty()) {
    const std::filesystem::path page = WriteGallery(a.gallery);
    std::cout << "gallery: " << page.string() << '\n';
    return support::kExitOk;
  }
  if (a.recording.empty() && a.data.empty())
    throw support::InputError("nothing to diagnose: give --data CSV or --recording FILE (see --help)");
  if (a.out.empty()) throw support::InputError("nowhere to write: give --out FOLDER (see --help)");
  if (!a.recording.empty() || support::DescribedPlant(a.model)) return RunDescribed(a);
  return RunBuiltIn(a);
}

}  // namespace
}  // namespace armcmc::gap

int main(int argc, char** argv) {
  armcmc::gap::KeepMemory();
  CLI::App app{"Finds the physics that a model is missing."};
  armcmc::gap::Arguments arguments;
  armcmc::gap::Declare(&app, &arguments);
  return armcmc::support::RunProgram(app, "armcmc-gap", argc, argv, [&] { return armcmc::gap::Run(arguments); });
}
