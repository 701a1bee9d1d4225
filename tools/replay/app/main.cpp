#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>

#include "armcmc/estimator.hpp"
#include "armcmc/replay/estimate_csv.hpp"
#include "armcmc/replay/pack_source.hpp"
#include "armcmc/replay/prediction_csv.hpp"
#include "armcmc/replay/replay.hpp"
#include "armcmc/support/estimator_config.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/progress.hpp"
#include "armcmc/support/shared_files.hpp"
#include "armcmc/support/strict_toml.hpp"
#include "report.hpp"

namespace armcmc::replay {
namespace {

struct Arguments {
  std::string config, data, out, model, draws_from, predictions, report, prefix;
  std::optional<std::uint64_t> seed;
  bool skip_bad = false;
};

void Declare(CLI::App* app, Arguments* a) {
  app->add_option("--config", a->config, "Configuration, by path or by name (hunt_crossley)")->required();
  app->add_option(
         "--data", a->data,
         "Recording: a CSV of samples (hunt_crossley: t,x,v,f; soft_actuator: t,u_c,u_d,p,pdot,alpha) or an LCM log")
      ->required();
  app->add_option("--out", a->out, "CSV of estimates to write, one row a pack")->required();
  app->add_option("--model", a->model,
                  "Built-in model or model file (.toml) instead of the model of the configuration");
  app->add_option("--seed", a->seed, "Seed instead of that of the configuration");
  app->add_option(
      "--draws-from", a->draws_from,
      "Repeat the numbers of draws of this run: an estimate CSV or an LCM log (a log given as --data is its "
      "own record)");
  app->add_option("--predictions", a->predictions, "CSV of the predicted output of every sample to write");
  app->add_option("--report", a->report, "JSON summary to write");
  app->add_option("--prefix", a->prefix, "Prefix of the LCM channel names");
  app->add_flag("--skip-bad", a->skip_bad, "Count and skip bad rows of a CSV instead of stopping");
  app->footer(
      "Runs the estimator over a recording: no threads, no deadline, the same result every time. Equal to a live run "
      "to\n"
      "the bit for the same packs, seed and numbers of draws.\n\n"
      "Example:\n"
      "  armcmc-plant --scenario hunt_crossley_paper --duration 20 --csv contact.csv\n"
      "  armcmc-replay --config hunt_crossley --data contact.csv --out estimates.csv");
}

std::ofstream OpenOutput(const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  if (!file) throw support::InputError(path + ": cannot be written");
  return file;
}

void Close(std::ofstream* file, const std::string& path) {
  if (!file->flush()) throw std::runtime_error(path + ": writing failed");
}

int Run(const Arguments& a) {
  auto root = support::StrictTable::FromFile(support::FindSharedFile("config", a.config));
  EstimatorSettings settings = support::ReadEstimatorSettings(root, a.model);
  support::StrictTable timing = root.Table("timing");
  SourceRequest request;
  request.period = 1e-3 * timing.Number("period_ms", 100.0, 1.0, 10'000.0);
  // When a live run computes is not the matter of a replay.
  for (const char* key : {"deadline_ms", "adjust_budget_ms"}) timing.LeaveToOthers(key);
  for (const char* key : {"rt", "lcm", "gap_log"}) root.LeaveToOthers(key);
  root.Finish();
  if (a.seed) settings.sampler.seed = *a.seed;

  Estimator estimator(settings);
  request.data = a.data;
  request.plant = estimator.plant();
  request.num_inputs = estimator.num_inputs();
  request.skip_bad = a.skip_bad;
  request.prefix = a.prefix;
  request.draws_from = a.draws_from;
  for (int mode = 0; mode < estimator.num_modes(); ++mode) request.mode_names.emplace_back(estimator.mode_name(mode));
  const auto source = OpenSource(request);

  std::ofstream out = OpenOutput(a.out);
  EstimateCsv estimates(estimator, &out);
  std::ofstream predictions_file;
  std::optional<PredictionCsv> predictions;
  if (!a.predictions.empty()) {
    predictions_file = OpenOutput(a.predictions);
    predictions.emplace(&predictions_file);
  }
  ReplaySummary summary;
  {
    support::Progress progress("replay");
    summary = Replay(source.get(), &estimator, [&](const RecordedPack& recorded, const Estimate& estimate) {
      estimates.Write(estimate);
      if (predictions) predictions->Write(recorded, estimate);
      progress.Update(source->progress());
    });
  }
  Close(&out, a.out);
  if (predictions) Close(&predictions_file, a.predictions);
  if (!a.report.empty()) WriteReport(a.report, estimator, *source, summary);
  std::cout << SummaryText(estimator, *source, summary) << "estimates: " << a.out << '\n';
  if (summary.packs == 0) throw support::InputError(a.data + ": holds no usable pack");
  return support::kExitOk;
}

}  // namespace
}  // namespace armcmc::replay

int main(int argc, char** argv) {
  CLI::App app{"Estimates the parameters of a recorded plant, pack by pack."};
  armcmc::replay::Arguments arguments;
  armcmc::replay::Declare(&app, &arguments);
  return armcmc::support::RunProgram(app, "armcmc-replay", argc, argv, [&] { return armcmc::replay::Run(arguments); });
}
