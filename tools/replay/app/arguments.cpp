#include "arguments.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "armcmc/models/registry.hpp"
#include "armcmc/replay/lcm_source.hpp"
#include "armcmc/support/model_file.hpp"
#include "armcmc/support/plant_library.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/recording.hpp"

namespace armcmc::replay {

using support::InputError;

namespace {

/// "NAME: t,INPUT,..,OUTPUT; ..." of every plant that is compiled in.
std::string ColumnsOfModels() {
  std::string text;
  for (const ModelInfo* model : CompiledModels()) {
    text += (text.empty() ? "" : "; ") + std::string(model->name) + ": t,";
    for (std::size_t i = 0; i < static_cast<std::size_t>(model->num_inputs); ++i)
      text += std::string(model->compiled->inputs[i].name) + ",";
    text += model->compiled->output.name;
  }
  return text;
}

}  // namespace

void Declare(CLI::App* app, Arguments* a) {
  const std::string plant = DefaultModel();
  app->add_option("--config", a->config,
                  "Configuration, by path or by name (" + DefaultModel() +
                      "); default for an LCM log: that of its plant, if it needs one")
      ->type_name("FILE");
  app->add_option(
         "--data", a->data,
         "Recording: a CSV of samples (" + ColumnsOfModels() + "; a plant file: t and its signals) or an LCM log")
      ->type_name("FILE");
  app->add_option("--recording", a->recording,
                  "Instead of --data: a recording file, which maps the columns of a CSV to the signals of a plant "
                  "(--model: another plant)")
      ->type_name("FILE");
  app->add_option("--data-dir", a->data_dir, "Folder of the CSV of --recording, if not that of the recording file")
      ->type_name("DIR");
  app->add_option("--out", a->out, "CSV of estimates to write, one row per pack; with --compare: the HTML report")
      ->type_name("FILE");
  app->add_option("--model", a->model,
                  "Built-in model, model file or plant file (armcmc-model) instead of the model of the configuration; "
                  "a plant needs no configuration")
      ->type_name("FILE");
  app->add_option("--seed", a->seed, "Seed, instead of the one in the configuration")->type_name("N");
  app->add_option(
         "--draws-from", a->draws_from,
         "Repeat the numbers of draws of this run: an estimate CSV or an LCM log (by default, those in the log "
         "given as --data)")
      ->type_name("FILE");
  app->add_flag("--verify", a->verify,
                "Compare bit by bit with the estimates and posteriors in the log (--data); exit 1 if they differ");
  app->add_option("--compare", a->compare, "Run again with this configuration and report both runs (--out, HTML)")
      ->type_name("FILE");
  app->add_option("--compare-model", a->compare_model, "Model of the second run, with or without --compare")
      ->type_name("FILE");
  app->add_option(
         "--calibrate", a->calibrate,
         "Configuration to write, with threshold, noise law, noise scale and rho determined from a recording of normal "
         "operation; a report (.html) beside it shows the evidence")
      ->type_name("FILE");
  app->add_option("--false-modifications", a->false_modifications,
                  "With --calibrate: accepted share of packs with a false modification")
      ->type_name("SHARE")
      ->check(CLI::Range(1e-6, 0.2))
      ->capture_default_str();
  app->add_option("--predictions", a->predictions, "CSV to write with the predicted output of every sample")
      ->type_name("FILE");
  app->add_option("--report", a->report, "JSON summary to write")->type_name("FILE");
  app->add_option("--prefix", a->prefix, "Prefix of the LCM channel names")->type_name("P");
  app->add_flag("--skip-bad", a->skip_bad, "Count and skip bad rows of a CSV instead of stopping");
  app->footer(
      "Runs the estimator over a recording, without threads or deadlines. The result is reproducible, and "
      "bit-identical\n"
      "to a live run with the same packs, seed and numbers of draws.\n\n"
      "Example:\n"
      "  armcmc-plant --scenario " +
      plant +
      "_paper --duration 20 --csv contact.csv\n"
      "  armcmc-replay --config " +
      plant +
      " --data contact.csv --out estimates.csv\n"
      "  armcmc-replay --model axis.toml --data axis.csv --out estimates.csv\n"
      "  armcmc-replay --recording axis_recording.toml --out estimates.csv\n"
      "  armcmc-replay --data run.lcm --verify\n"
      "  armcmc-replay --model axis.toml --data axis.lcm --out estimates.csv\n"
      "  armcmc-replay --data run.lcm --config " +
      plant +
      " --compare other.toml --out report.html\n"
      "  armcmc-replay --data normal.lcm --config " +
      plant +
      " --calibrate calibrated.toml\n"
      "Exit status: 0 ok, 1 the runs differ (--verify) or another failure, 2 bad usage or input.");
}

namespace {

/// The plant of a log of packs of a plant that came along as a file; empty: it holds those of a compiled one.
std::string DescribedPlantOf(const std::string& log, const std::string& prefix) {
  const std::string plant = DescribedPlantOfLog(log, prefix);
  if (plant.empty()) return plant;
  const std::vector<std::string> known = support::PlantNames();
  if (std::find(known.begin(), known.end(), plant) == known.end())
    throw InputError(log + ": holds packs of " + plant + ", a plant that a file describes: say --model FILE");
  std::cout << "model: " << plant << ", by the plant of the log\n";
  return plant;
}

/// What is named by a recording is what is estimated from.
void CompleteRecording(Arguments* a) {
  if (!a->data.empty()) throw InputError("--recording and --data exclude each other: each says what the data are");
  if (a->skip_bad) throw InputError("--skip-bad: a recording file says which rows count, [rows] drop");
  a->data = a->recording;
  if (a->model.empty()) a->model = support::RecordingModel(a->recording);
}

}  // namespace

void Complete(Arguments* a) {
  if (!a->recording.empty()) CompleteRecording(a);
  if (!a->data_dir.empty() && a->recording.empty()) throw InputError("--data-dir goes with --recording");
  if (a->data.empty() && a->config.empty() && a->model.empty())
    throw InputError("--data, and --model or --config, are required: what to estimate from, and what (see --help)");
  if (a->data.empty()) throw InputError("--data is required: a CSV or an LCM log");
  const bool is_log = a->recording.empty() && IsLcmLog(a->data);
  if (is_log && a->config.empty() && a->model.empty()) a->model = DescribedPlantOf(a->data, a->prefix);
  const bool described = !a->model.empty() && support::DescribedPlant(a->model) != nullptr;
  if (a->config.empty() && !described) {
    if (!is_log) throw InputError("--model or --config is required for a CSV: which plant is it?");
    a->config = ModelOfLog(a->data, a->prefix).name;
    std::cout << "configuration: " << a->config << ", by the plant of the log\n";
  }
  if (!a->calibrate.empty() && a->config.empty())
    throw InputError("--calibrate needs --config: what it writes is that with other numbers");
  if (a->verify && !is_log) throw InputError("--verify needs an LCM log as --data: a CSV holds no estimates");
  if (a->verify && !a->draws_from.empty()) throw InputError("--verify takes the draws from --data; drop --draws-from");
  const int jobs = (a->verify ? 1 : 0) + (a->compares() ? 1 : 0) + (a->calibrate.empty() ? 0 : 1);
  if (jobs > 1) throw InputError("--verify, --compare and --calibrate exclude each other");
  if (a->compares() && a->out.empty()) throw InputError("--out is required: the report of --compare");
  if (jobs == 0 && a->out.empty()) throw InputError("--out is required");
}

}  // namespace armcmc::replay
