#include <signal.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/estimator.hpp"
#include "armcmc/estimator_status_t.hpp"
#include "armcmc/models/registry.hpp"
#include "armcmc/rt/allocation_counter.hpp"
#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/disturbed_engine.hpp"
#include "armcmc/rt/pipeline.hpp"
#include "armcmc/rt/process_setup.hpp"
#include "armcmc/support/program.hpp"
#include "event_printer.hpp"
#include "options.hpp"
#include "plant_run.hpp"
#include "service_notify.hpp"

namespace armcmc::app {
namespace {

constexpr char kName[] = "armcmc-estimator";
constexpr char kDescription[] =
    "Estimates the parameters of a plant in real time. Receives packs of measurements over LCM, updates the posterior\n"
    "of the parameters before a deadline, and publishes the estimate, its marginals and a status.";
std::string Footer() {
  return "Channels: receives PLANT_PACK, or PLANT_PACK_V2 for a plant described by a file; publishes EST_ESTIMATE,\n"
         "EST_POSTERIOR, EST_CHANGE, EST_STATUS (all with the prefix).\n"
         "Ctrl-C stops within one step, prints the summary and writes the report.\n\n"
         "Example: two terminals on one computer\n"
         "  armcmc-estimator --model " +
         DefaultModel() + " --report estimator.json\n  armcmc-plant --scenario " + DefaultModel() +
         "_paper --duration 20\n"
         "A plant of your own, from a file of 25 lines (armcmc-model new):\n"
         "  armcmc-estimator --model my_axis.toml --report estimator.json\n"
         "Several plants in one process, up to " +
         std::to_string(rt::Pipeline::kMaxLanes) +
         ": --model, --prefix and --report once for each\n"
         "  armcmc-estimator --model joint.toml --model joint.toml --prefix J1_ --prefix J2_\n"
         "Exit status: 0 ok, 2 bad usage or input, 1 any other failure.";
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
bool SuperviseUntilStopped(rt::Pipeline* pipeline, const sigset_t& signals,
                           const std::vector<std::unique_ptr<PlantRun>>& plants, EventPrinter* printer) {
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
    const Nanos now = rt::MonotonicNow();
    const bool second = now >= next_second || !running;
    for (const auto& plant : plants) plant->PrintEvents(now, second && !give_up);
    if (give_up) return false;
    if (second) next_second = now + rt::kNanosPerSecond;
  }
  return true;
}

/// What runs beside the pipeline looks at its lanes until it is stopped.
struct StopPlantsOnExit {
  const std::vector<std::unique_ptr<PlantRun>>& plants;
  ~StopPlantsOnExit() {
    for (const auto& plant : plants) plant->Stop();
  }
};

int Run(const Options& options) {
  const Configuration configuration = Load(options);

  // Blocked before the first thread starts: all inherit it, and sigtimedwait() below is the only one to hear them.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);

  std::vector<std::unique_ptr<PlantRun>> plants;
  for (const PlantConfiguration& plant : configuration.plants)
    plants.push_back(std::make_unique<PlantRun>(plant, configuration.plants.size() > 1));
  rt::Injection injection(configuration.inject);
  rt::DisturbedEngine disturbed(&plants[0]->engine(), &injection);
  const bool injects = !configuration.inject.empty();
  rt::PipelineOptions pipeline_options;
  pipeline_options.max_steps = options.steps;
  if (rt::HeapCallsAreCounted()) pipeline_options.heap_probe = &rt::ThreadHeapCalls;
  if (injects) pipeline_options.injection = &injection;
  std::vector<rt::LanePlant> lanes;
  lanes.reserve(plants.size());
  for (const auto& plant : plants)
    lanes.push_back(plant->ForPipeline(injects ? static_cast<rt::StepEngine*>(&disturbed) : &plant->engine()));
  rt::Pipeline pipeline(configuration.rt, lanes, pipeline_options);
  const StopPlantsOnExit stop_plants{plants};
  const auto say = [](const std::string& line) { std::cerr << line + "\n"; };
  for (std::size_t i = 0; i < plants.size(); ++i)
    plants[i]->Resume(&pipeline.lane(i), [&say](const std::string& line) { say(std::string(kName) + ": " + line); });
  const Nanos start_ns = rt::MonotonicNow();
  try {
    pipeline.Start();
  } catch (const rt::PrivilegeError& error) {
    std::cerr << kName << ": " << error.what() << '\n';  // several lines: the remedy
    return support::kExitFailure;
  }
  WarnWhenDegraded(pipeline);
  if (options.verbose) {
    for (const PlantConfiguration& plant : configuration.plants)
      std::cerr << kName << ": " << plant.prefix << (plant.prefix.empty() ? "" : ": ") << plant.estimator.model
                << " on " << configuration.rt.lcm_url << ", scoring with " << InstructionSet() << '\n';
  }
  for (const auto& plant : plants) plant->Start(start_ns, options.verbose, say);
  EventPrinter printer(std::cerr, start_ns, options.verbose);  // of what concerns no plant in particular
  if (!SuperviseUntilStopped(&pipeline, signals, plants, &printer)) {
    std::cerr << kName << ": a stage hangs and [rt.watchdog] on_hang = \"exit\": the process ends now.\n";
    std::_Exit(support::kExitFailure);  // a thread that hangs cannot be joined
  }
  for (const auto& plant : plants) plant->Stop();
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);  // a second Ctrl-C may end a program whose disk hangs

  for (const auto& plant : plants) plant->Conclude(pipeline);
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
                 "Configuration: a file, or the name of a bundled one. Default: that of the model.\n"
                 "Several plants: once for all or once for each; they share threads, timing and bus")
      ->type_name("FILE")
      ->allow_extra_args(false);
  cli.add_option("--model", options.model,
                 "Model: " + ModelNames() +
                     ", a bundled plant (armcmc-model list),\na plant file or a model file (.toml). Several plants: "
                     "once for each")
      ->type_name("NAME")
      ->allow_extra_args(false);
  cli.add_option("--lcm-url", options.lcm_url,
                 "LCM bus, for example udpm://239.255.76.67:7667?ttl=0. Default: from the configuration")
      ->type_name("URL");
  cli.add_option("--prefix", options.prefix,
                 "Prefix of every channel name. Default: from the configuration. Several plants: once for each")
      ->type_name("P")
      ->allow_extra_args(false);
  cli.add_option("--steps", options.steps, "Stop after N steps. Default: run until stopped")
      ->type_name("N")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 62));
  cli.add_option("--report", options.report, "Write a JSON report of the run. Several plants: once for each")
      ->type_name("FILE")
      ->allow_extra_args(false);
  cli.add_option("--gap-log", options.gap_log,
                 "Folder for the data around a model gap alarm. Default: from the configuration (gap_logs)")
      ->type_name("DIR");
  cli.add_option(
         "--resume", options.resume,
         "Continue from the state saved in this file, and save the state to it once per second.\nSeveral plants: "
         "once for each")
      ->type_name("FILE")
      ->allow_extra_args(false);
  cli.add_flag("--verbose", options.verbose, "Also print lost and dropped packs");
  return support::RunProgram(cli, app::kName, argc, argv, [&options] { return app::Run(options); });
}
