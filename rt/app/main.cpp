#include <signal.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/estimator.hpp"
#include "armcmc/estimator_status_t.hpp"
#include "armcmc/models/registry.hpp"
#include "armcmc/rt/allocation_counter.hpp"
#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/disturbed_engine.hpp"
#include "armcmc/rt/pipeline.hpp"
#include "armcmc/rt/process_setup.hpp"
#include "armcmc/rt/snapshot_hand_over.hpp"
#include "armcmc/rt/step_engine.hpp"
#include "armcmc/snapshot.hpp"
#include "armcmc/support/estimator_config.hpp"
#include "armcmc/support/model_file.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/shared_files.hpp"
#include "armcmc/support/strict_toml.hpp"
#include "event_printer.hpp"
#include "gap_log.hpp"
#include "report.hpp"
#include "rt_config.hpp"
#include "service_notify.hpp"
#include "snapshot_saver.hpp"
#include "summary.hpp"

namespace armcmc::app {
namespace {

constexpr char kName[] = "armcmc-estimator";
constexpr char kDescription[] =
    "Estimates the parameters of a plant in real time. Listens to packs of measurements on LCM, updates the posterior "
    "of\n"
    "the parameters within a deadline, and publishes the estimate, its marginals and the state of health.";
std::string Footer() {
  return "Channels: listens to PLANT_PACK, or PLANT_PACK_V2 for a plant that a file describes; publishes "
         "EST_ESTIMATE,\n"
         "EST_POSTERIOR, EST_CHANGE, EST_STATUS (all behind the prefix).\n"
         "Ctrl-C stops within one step, prints the summary and writes the report.\n\n"
         "Example: two terminals on one computer\n"
         "  armcmc-estimator --model " +
         DefaultModel() + " --report estimator.json\n  armcmc-plant --scenario " + DefaultModel() +
         "_paper --duration 20\n"
         "A plant of your own, from a file of 25 lines (armcmc-model new):\n"
         "  armcmc-estimator --model my_axis.toml --report estimator.json\n";
}

struct Options {
  std::string config;
  std::string model;
  std::string lcm_url;
  std::string prefix;
  std::string report;
  std::string gap_log;
  std::string resume;
  std::int64_t steps = 0;
  bool verbose = false;
};

struct Configuration {
  EstimatorSettings estimator;
  rt::RtSettings rt;
  GapLogSettings gap_log;
  std::vector<rt::InjectionItem> inject;
};

/// Without --config a built-in model has a file of its own, a plant that a file describes the defaults; with --config,
/// --model replaces the model of the file.
support::StrictTable OpenConfiguration(const Options& options, bool described) {
  // A wrong name or model file is told first: it is the model's fault, not the configuration's.
  const std::string base = options.model.empty() || described ? DefaultModel() : support::BaseModel(options.model);
  if (described && options.config.empty())
    return support::StrictTable::FromText("schema = 1\n", "the default configuration");
  return support::StrictTable::FromFile(
      support::FindSharedFile("config", options.config.empty() ? base : options.config));
}

Configuration Load(const Options& options) {
  const bool described = support::DescribedPlant(options.model) != nullptr;
  support::StrictTable root = OpenConfiguration(options, described);
  const bool decides = described || !options.config.empty() || support::IsModelFile(options.model);
  Configuration configuration;
  configuration.estimator = support::ReadEstimatorSettings(root, decides ? options.model : "");
  configuration.rt = ReadRtSettings(root);
  configuration.gap_log = ReadGapLogSettings(root);
  configuration.gap_log.overlap = configuration.estimator.overlap;
  configuration.inject = ReadInjections(root);
  root.Finish();
  if (!options.lcm_url.empty()) configuration.rt.lcm_url = options.lcm_url;
  if (!options.prefix.empty()) configuration.rt.prefix = options.prefix;
  if (!options.gap_log.empty()) configuration.gap_log.directory = options.gap_log;
  configuration.rt.Validate();
  return configuration;
}

void WarnWhenDegraded(const rt::Pipeline& pipeline) {
  const auto names = rt::DegradedNames(pipeline.degraded_flags());
  if (names.empty()) return;
  std::cerr << kName << ": real-time behaviour is degraded (";
  for (std::size_t i = 0; i < names.size(); ++i) std::cerr << (i == 0 ? "" : ", ") << names[i];
  std::cerr << "); every status message says so.\n";
  const bool privileges_lack = std::any_of(names.begin(), names.end(), [](const std::string& name) {
    return name != "shared_cpu" && name != "injected_faults" && name != "cpus_sleep";
  });
  if (privileges_lack) std::cerr << rt::PrivilegeRemedy() << '\n';
  if ((pipeline.degraded_flags() & estimator_status_t::DEGRADED_CPUS_SLEEP) != 0) {
    std::cerr << rt::CpuWakeRemedy() << '\n';
  }
}

/// Prints events until the pipeline stops by itself or a signal of the set asks it to.
/// A service manager hears that all stages are alive, and only then.
/// @return false when a stage hangs and the configuration wants the process to end then.
bool Attend(rt::Pipeline* pipeline, const sigset_t& signals, EventPrinter* printer) {
  constexpr timespec kPoll{0, 50'000'000};
  ServiceNotify service;
  service.Ready();
  Nanos next_second = rt::MonotonicNow() + rt::kNanosPerSecond;
  bool running = true;
  while (running) {
    if (sigtimedwait(&signals, nullptr, &kPoll) > 0) pipeline->RequestStop();
    running = !pipeline->stopping();
    const bool give_up = !pipeline->AllAlive() && pipeline->settings().on_hang == rt::OnHang::kExit;
    if (pipeline->AllAlive()) service.Alive(rt::MonotonicNow());
    if (!running || give_up) service.Stopping();
    if (!running && !give_up) pipeline->Join();
    rt::Event event;
    while (pipeline->TakeEvent(&event)) printer->Print(event);
    if (give_up) return false;
    if (const Nanos now = rt::MonotonicNow(); now >= next_second || !running) {
      printer->PrintHeldBack(now);
      next_second = now + rt::kNanosPerSecond;
    }
  }
  return true;
}

/// A file that cannot be written is found out before the run, not after it.
void CheckPath(const std::string& option, const std::string& path) {
  if (path.empty()) return;
  const auto folder = std::filesystem::absolute(path).parent_path();
  if (!std::filesystem::is_directory(folder) || std::filesystem::is_directory(path)) {
    throw support::InputError(option + " " + path + ": expected a file in a folder that exists");
  }
}

void Say(const std::string& line) { std::cerr << std::string(kName) + ": " + line + "\n"; }

/// Reads the snapshot of --resume into the engine and sets up its successor. nullptr without --resume.
std::unique_ptr<SnapshotSaver> Resume(const Options& options, rt::EstimatorEngine* engine,
                                      rt::SnapshotHandOver* snapshots, const SnapshotSaver::OnFailure& on_failure) {
  if (options.resume.empty()) return nullptr;
  Snapshot start = LoadSnapshot(
      options.resume, SnapshotIdentity(engine->estimator().settings()), rt::RealtimeMicros(),
      [engine](const Snapshot& s) { return engine->Resume(s.adjusted, s.executed); }, Say);
  engine->SetSnapshots(snapshots);
  return std::make_unique<SnapshotSaver>(options.resume, std::move(start), snapshots, Say, on_failure);
}

std::optional<rt::SnapshotCounts> SnapshotReport(const SnapshotSaver* saver) {
  if (saver == nullptr) return std::nullopt;
  return rt::SnapshotCounts{saver->path(), saver->resumed_from(), saver->written(), saver->failed()};
}

int Run(const Options& options) {
  const Configuration configuration = Load(options);
  CheckPath("--report", options.report);
  CheckPath("--resume", options.resume);
  if (!options.resume.empty() && configuration.estimator.method != Method::kArmcmc) {
    throw support::InputError("--resume: only method = \"armcmc\" keeps what it has learnt; leave --resume out");
  }
  if (!options.resume.empty() && configuration.estimator.overlap > 1) {
    throw support::InputError("--resume: keeps one posterior, and with [timing] overlap = " +
                              std::to_string(configuration.estimator.overlap) +
                              " there are as many; leave --resume out");
  }

  // Blocked before the first thread starts: all inherit it, and sigtimedwait() below is the only one to hear them.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);

  const auto snapshots = std::make_unique<rt::SnapshotHandOver>(Estimator::kSnapshotBytes);
  rt::EstimatorEngine engine(configuration.estimator);
  rt::Injection injection(configuration.inject);
  rt::DisturbedEngine disturbed(&engine, &injection);
  const bool injects = !configuration.inject.empty();
  rt::PipelineOptions pipeline_options;
  pipeline_options.max_steps = options.steps;
  if (rt::HeapCallsAreCounted()) pipeline_options.heap_probe = &rt::ThreadHeapCalls;
  pipeline_options.record_packs = engine.estimator().watches_gap();
  if (injects) pipeline_options.injection = &injection;
  rt::StepEngine* computes = &engine;
  if (injects) computes = &disturbed;
  rt::Pipeline pipeline(configuration.rt, computes, pipeline_options);
  const auto saver = Resume(options, &engine, snapshots.get(),
                            [&pipeline] { pipeline.RaiseFault(estimator_status_t::FAULT_SNAPSHOT); });
  const Nanos start_ns = rt::MonotonicNow();
  try {
    pipeline.Start();
  } catch (const rt::PrivilegeError& error) {
    std::cerr << kName << ": " << error.what() << '\n';  // several lines: the remedy
    return support::kExitFailure;
  }
  WarnWhenDegraded(pipeline);
  if (options.verbose) {
    std::cerr << kName << ": " << configuration.estimator.model << " on " << configuration.rt.lcm_url
              << ", scoring with " << InstructionSet() << '\n';
  }
  EventPrinter printer(std::cerr, start_ns, options.verbose,
                       [&engine](int check) { return std::string(engine.estimator().gap_check_name(check)); });
  std::unique_ptr<GapLog> gap_log;
  if (pipeline.record() != nullptr) {
    gap_log =
        std::make_unique<GapLog>(configuration.gap_log, ColumnsOf(configuration.estimator), pipeline.record(),
                                 &pipeline.gap_alarm(), [](const std::string& line) { std::cerr << line + "\n"; });
    gap_log->Start();
  }
  if (saver) saver->Start();
  if (!Attend(&pipeline, signals, &printer)) {
    std::cerr << kName << ": a stage hangs and [rt.watchdog] on_hang = \"exit\": the process ends now.\n";
    std::_Exit(support::kExitFailure);  // a thread that hangs cannot be joined
  }
  if (gap_log) gap_log->Stop();
  if (saver) saver->Stop();
  const std::string window = gap_log ? gap_log->path() : "";
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);  // a second Ctrl-C may end a program whose disk hangs

  std::cout << SummaryText(pipeline, engine.estimator(), window);
  if (!options.report.empty()) {
    rt::WriteReport(pipeline, options.report, window, SnapshotReport(saver.get()));
    std::cout << "\nreport: " << options.report << '\n';
  }
  return support::kExitOk;
}

}  // namespace
}  // namespace armcmc::app

int main(int argc, char** argv) {
  using namespace armcmc;
  app::Options options;
  CLI::App cli{app::kDescription};
  cli.footer(app::Footer());
  cli.add_option("--config", options.config,
                 "Configuration: a file, or the name of one that came with the product. Default: that of the model")
      ->type_name("FILE");
  cli.add_option("--model", options.model,
                 "Model: " + ModelNames() +
                     ", a plant that came along (armcmc-model list),\na plant file or a model file (.toml)")
      ->type_name("NAME");
  cli.add_option("--lcm-url", options.lcm_url,
                 "LCM bus, for example udpm://239.255.76.67:7667?ttl=0. Default: the configuration's")
      ->type_name("URL");
  cli.add_option("--prefix", options.prefix, "Put before every channel name. Default: the configuration's")
      ->type_name("P");
  cli.add_option("--steps", options.steps, "Stop after N steps. Default: run until stopped")
      ->type_name("N")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 62));
  cli.add_option("--report", options.report, "Write a JSON report of the run")->type_name("FILE");
  cli.add_option("--gap-log", options.gap_log,
                 "Folder for the data around a suspected gap. Default: the configuration's (gap_logs)")
      ->type_name("DIR");
  cli.add_option("--resume", options.resume,
                 "Go on from what was learnt before, kept in this file, and keep it up to date, once per second")
      ->type_name("FILE");
  cli.add_flag("--verbose", options.verbose, "Also print lost and dropped packs");
  return support::RunProgram(cli, app::kName, argc, argv, [&options] { return app::Run(options); });
}
