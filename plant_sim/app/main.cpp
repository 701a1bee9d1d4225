#include <CLI/CLI.hpp>
#include <algorithm>
#include <armcmc/support/program.hpp>
#include <armcmc/support/shared_files.hpp>
#include <cctype>
#include <cmath>
#include <string>

#include "live_run.hpp"
#include "offline_run.hpp"
#include "scenario_file.hpp"

namespace {

using armcmc::plant_sim::FaultPlan;
using armcmc::plant_sim::PlantOptions;
using armcmc::plant_sim::Scenario;
using armcmc::support::InputError;

constexpr const char* kDescription =
    "A simulated plant. It publishes measurement packs over LCM in real time, listens to the estimates, and scores\n"
    "them against the parameters that it alone knows.";

constexpr const char* kFooter =
    "Examples:\n"
    "  armcmc-plant --scenario hunt_crossley_paper --seed 7 --report score.json\n"
    "  armcmc-plant --scenario hunt_crossley_step --csv step.csv      (no LCM, as fast as possible)\n"
    "  armcmc-plant --inject nan@30,late@60:150\n"
    "Stop with Ctrl-C: the score so far is printed.\n"
    "Faults of --inject, each KIND@PACK: nan (a NaN among the samples), size (more samples than a pack holds),\n"
    "duplicate (sent twice), reorder (sent after the next), drop (not sent), foreign (another LCM type before it),\n"
    "garbage (undecodable bytes before it), late@PACK:MS (sent MS milliseconds late).\n"
    "Exit status: 0 ok, 2 bad usage or input, 1 any other failure.";

/// LCM reads a channel name as a regular expression when subscribing: only characters that mean themselves.
void CheckPrefix(const std::string& prefix) {
  const bool plain = std::all_of(prefix.begin(), prefix.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '/';
  });
  if (!plain || prefix.size() > 32)
    throw InputError("--prefix \"" + prefix + "\": expected at most 32 letters, digits, _ - or /");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(kDescription);
  app.footer(kFooter);
  std::string scenario_name = "hunt_crossley_paper", inject;
  double duration_s = 0.0;
  PlantOptions options;
  app.add_option("--scenario", scenario_name, "Scenario file, or the name of one that came with the program")
      ->capture_default_str();
  app.add_option("--seed", options.seed, "Seed of the sensor noise: the same seed gives the same data")
      ->capture_default_str();
  app.add_option("--duration", duration_s, "Seconds to run, instead of the scenario's duration");
  CLI::Option* url =
      app.add_option("--lcm-url", options.lcm_url, "LCM bus; another port is another bus")->capture_default_str();
  app.add_option("--prefix", options.prefix, "Goes before every channel name, so that many plants share one bus");
  app.add_option("--log", options.log_path, "Write what is published to an LCM log");
  app.add_option("--csv", options.csv_path, "Write the samples and the truth; without --lcm-url nothing is published");
  app.add_option("--report", options.report_path, "Write the score as JSON");
  app.add_option("--inject", inject, "Faults to inject on purpose, comma separated");

  return armcmc::support::RunProgram(app, "armcmc-plant", argc, argv, [&] {
    if (app.count("--inject") > 0) {
      try {
        options.faults = FaultPlan::Parse(inject);
      } catch (const std::invalid_argument& error) {
        throw InputError(std::string("--inject ") + error.what());
      }
    }
    CheckPrefix(options.prefix);
    Scenario scenario = armcmc::plant_sim::LoadScenario(armcmc::support::FindSharedFile("scenarios", scenario_name));
    if (app.count("--duration") > 0) {
      if (!std::isfinite(duration_s) || duration_s <= 0.0 || duration_s > 1e6)
        throw InputError("--duration " + std::to_string(duration_s) + ": expected seconds in (0, 1000000]");
      scenario.duration_s = duration_s;
    }
    if (scenario.num_packs() < 1)
      throw InputError("the duration of " + std::to_string(scenario.duration_s) + " s does not hold one pack of " +
                       std::to_string(scenario.pack_period_s()) + " s");
    if (options.csv_path.empty() || url->count() > 0) return armcmc::plant_sim::RunLive(scenario, options);
    if (!options.report_path.empty()) throw InputError("--report needs a live run: give --lcm-url, or leave --csv out");
    return armcmc::plant_sim::RunOffline(scenario, options);
  });
}
