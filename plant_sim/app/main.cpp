#include <CLI/CLI.hpp>
#include <algorithm>
#include <armcmc/support/printable.hpp>
#include <armcmc/support/program.hpp>
#include <armcmc/support/shared_files.hpp>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "armcmc/plant_sim/effects/hide.hpp"
#include "described_run.hpp"
#include "live_run.hpp"
#include "model_file.hpp"
#include "offline_run.hpp"
#include "play_runs.hpp"
#include "recording_run.hpp"
#include "scenario_file.hpp"
#include "sealed_file.hpp"

namespace {

using armcmc::plant_sim::FaultPlan;
using armcmc::plant_sim::PlantOptions;
using armcmc::plant_sim::Scenario;
using armcmc::support::InputError;

constexpr const char* kDescription =
    "A simulated plant. It publishes measurement packs over LCM in real time, listens to the estimates, and scores\n"
    "them against the true parameters, which only it knows.";

constexpr const char* kFooter =
    "  armcmc-plant --scenario contact_rich --csv rich.csv      (no LCM, as fast as possible)\n"
    "  armcmc-plant --inject nan@30,late@60:150\n"
    "Stop with Ctrl-C: the score so far is printed.\n"
    "Faults of --inject, each KIND@PACK: nan (a NaN among the samples), size (more samples than a pack holds),\n"
    "duplicate (sent twice), reorder (sent after the next), drop (not sent), foreign (preceded by another LCM type),\n"
    "garbage (preceded by undecodable bytes), zero (every value 0), huge (1e300 among the samples), corrupt (damaged\n"
    "bytes), late@PACK:MS (sent MS milliseconds late), clock@PACK:MS (the plant's clock jumps ahead by MS "
    "milliseconds).\n"
    "Hidden effects: --hide-effect NAME[:VARIANT][,NAME[:VARIANT]] adds one or two effects that the base equations\n"
    "lack; \"random\" draws none, one, two, or one that is in no catalogue; \"none\" hides nothing.\n"
    "  armcmc-plant --hide-effect random --seed 5 --sealed truth.json --csv data.csv\n"
    "  armcmc-plant --hide-effect coulomb_friction:tanh --effect-gate from:8 --sealed truth.json --csv data.csv\n"
    "The truth is written only to the sealed file, whose SHA-256 is printed. The CSV keeps its columns: an effect\n"
    "appears in f, while the truth columns remain those of the base equations. A scenario hides effects with\n"
    "[[hidden_effect]] tables: name, variant, gate, strength, seed (in the first table) and a table of fixed\n"
    "parameters, which are not drawn.\n"
    "Model files: --model FILE.toml, as read by armcmc-estimator and armcmc-replay, sets the true parameters and\n"
    "effects of the plant to their means; motion and noise remain those of the scenario.\n"
    "  armcmc-plant --scenario contact_rich --model found.toml --csv predicted.csv\n"
    "Plant files: --model FILE, or the name of a bundled plant, simulates any plant described by a file, with an\n"
    "independent implementation. Its scenario has schema, rate_hz, duration_s, seed, [truth] (parameter values; a\n"
    "list has one for each mode), [inputs] (NAME = { kind, amplitude, offset, frequency_hz, bandwidth_hz } with kind\n"
    "multisine, sine, chirp or steps, or { expression }, or { state }), [start], [noise] (law, std) and [[hidden]]\n"
    "(slot, value): effects that the plant file lacks. Without a scenario the true parameters are the prior means,\n"
    "and the inputs are multisines.\n"
    "  armcmc-plant --model my_axis.toml --csv axis.csv\n"
    "  armcmc-plant --model valve.toml --scenario valve_steps.toml --csv data.csv --log data.lcm\n"
    "Scenarios contact_* draw plant and motion from the seed; experiment_* are motions that separate effects.\n"
    "[motion] of a contact: tracking = \"prescribed\" with program (rich, sine, slow_triangle, fast_taps, step_hold,\n"
    "taps_of_depths, contact_chirp, free_air_chirp, free_air or strokes), depth (m), pace (2: twice as fast) and\n"
    "band_hz (low pass). [law] error: smooth relative rms deviation of the plant from its formula, drawn from the\n"
    "seed. [parameters]: a number, or a range { low, high, law, at_depth, times } to draw from. [noise.CHANNEL]:\n"
    "kind, std or std_share (of the rms in contact), correlation (between consecutive samples; with correlation_to\n"
    "drawn from a range), growth (with the size of the signal).\n"
    "Recordings: --recording FILE plays measured data of a plant file as packs in real time, each run as a restart\n"
    "of the plant; NaN and infinite values are sent unchanged.\n"
    "  armcmc-plant --recording emps_estimation.toml --data-dir measured --speed 2\n"
    "Exit status: 0 ok, 2 bad usage or input, 1 any other failure.";

/// The options about hidden effects, as given.
struct HideOptions {
  std::string effect, gate, sealed_path;
  double strength = 1.0;
};

/// Puts what --hide-effect asks for into the scenario and writes the sealed file.
void Hide(const CLI::App& app, const HideOptions& hide, std::uint64_t seed, Scenario* scenario) {
  using namespace armcmc::plant_sim;
  const bool asked = app.count("--hide-effect") > 0;
  for (const char* option : {"--effect-strength", "--effect-gate"})
    if (!asked && app.count(option) > 0) throw InputError(std::string(option) + " needs --hide-effect");
  if (asked && hide.sealed_path.empty())
    throw InputError("--hide-effect needs --sealed FILE, which records the hidden effects");
  if (asked && !scenario->hidden.empty())
    throw InputError("--hide-effect: the scenario hides effects of its own ([[hidden_effect]])");
  if (!(hide.strength >= 1e-3 && hide.strength <= 1e3))
    throw InputError("--effect-strength " + std::to_string(hide.strength) + ": expected a gap ratio in [0.001, 1000]");
  std::optional<Gate> gate;
  try {
    if (!hide.gate.empty()) gate = Gate::Parse(hide.gate);
  } catch (const std::invalid_argument& error) {
    throw InputError(std::string("--effect-gate ") + error.what());
  }
  if (asked && hide.effect != "none") {
    try {
      scenario->hidden =
          hide.effect == "random"
              ? DrawEffects(*scenario, hide.strength, gate, seed)
              : DecideEffects(*scenario, ParseEffectRequests(hide.effect, gate.value_or(Gate{}), hide.strength), seed);
    } catch (const std::invalid_argument& error) {
      throw InputError(std::string("--hide-effect ") + error.what());
    }
  }
  if (hide.sealed_path.empty()) return;
  if (!asked && scenario->hidden.empty()) throw InputError("--sealed: nothing is hidden; give --hide-effect");
  const std::string hash = WriteSealedFile(*scenario, seed, hide.sealed_path);
  std::printf("sealed %s: SHA-256 %s\n", armcmc::support::Escaped(hide.sealed_path).c_str(), hash.c_str());
}

/// LCM reads a channel name as a regular expression when subscribing: only characters that mean themselves.
void CheckPrefix(const std::string& prefix) {
  const bool plain = std::all_of(prefix.begin(), prefix.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '/';
  });
  if (!plain || prefix.size() > 32)
    throw InputError("--prefix \"" + prefix + "\": expected at most 32 letters, digits, _ - or /");
}

/// What --recording needs beyond PlantOptions.
struct RecordingOptions {
  std::string path, data_dir;
  double speed = 1.0;
};

/// Refuses options that are given in vain.
void Refuse(const CLI::App& app, const std::vector<const char*>& options, const std::string& why) {
  for (const char* option : options)
    if (app.count(option) > 0) throw InputError(option + why);
}

int Play(const CLI::App& app, const RecordingOptions& recording, const PlantOptions& options) {
  Refuse(app,
         {"--scenario", "--model", "--seed", "--duration", "--csv", "--report", "--inject", "--hide-effect",
          "--effect-strength", "--effect-gate", "--sealed"},
         " contradicts --recording, whose data are measured, not simulated");
  return armcmc::plant_sim::RunRecording(recording.path, recording.data_dir, recording.speed, options);
}

int Simulate(const CLI::App& app, const std::filesystem::path& plant_file, const std::optional<double>& duration_s,
             double speed, const PlantOptions& options) {
  Refuse(app, {"--report", "--inject", "--effect-strength", "--effect-gate"}, " is for the built-in plants alone");
  armcmc::plant_sim::DescribedRequest request;
  if (app.count("--scenario") > 0)
    request.scenario =
        armcmc::support::FindSharedFile("scenarios", app.get_option("--scenario")->as<std::string>()).string();
  request.duration_s = duration_s;
  if (app.count("--seed") > 0) request.seed = options.seed;
  request.speed = speed;
  request.live = options.csv_path.empty() || app.count("--lcm-url") > 0;
  return armcmc::plant_sim::RunDescribed(plant_file, request, options);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(kDescription);
  app.footer("Examples:\n  armcmc-plant --scenario " + armcmc::plant_sim::DefaultScenario() +
             " --seed 7 --report score.json\n" + kFooter);
  std::string scenario_name = armcmc::plant_sim::DefaultScenario(), model_path, inject;
  double duration_s = 0.0;
  PlantOptions options;
  HideOptions hide;
  RecordingOptions recording;
  app.add_option("--scenario", scenario_name, "Scenario file, or the name of a bundled one")
      ->type_name("FILE")
      ->capture_default_str();
  app.add_option(
         "--model", model_path,
         "Plant file, or name of a bundled plant, to simulate; or a model file whose parameters and effects, at their\n"
         "means, are the true ones of the scenario's plant")
      ->type_name("FILE");
  app.add_option("--recording", recording.path, "Recording file to play instead of simulating a plant")
      ->type_name("FILE");
  app.add_option("--data-dir", recording.data_dir, "Folder of the recording's CSV, if not that of the recording file")
      ->type_name("DIR");
  app.add_option("--speed", recording.speed, "Play this many times as fast as recorded")
      ->type_name("FACTOR")
      ->capture_default_str();
  app.add_option("--seed", options.seed,
                 "Seed of the sensor noise, and of random motions and parameters: the same seed gives the same data")
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--duration", duration_s, "Seconds to run, instead of the scenario's duration")->type_name("S");
  CLI::Option* url = app.add_option("--lcm-url", options.lcm_url, "LCM bus; a different port is a different bus")
                         ->type_name("URL")
                         ->capture_default_str();
  CLI::Option* stride =
      app.add_option("--stride", options.stride,
                     "Send a pack every so many samples, so that packs overlap; must divide the number of samples in\n"
                     "a pack. Default: from the scenario")
          ->type_name("N");
  app.add_option("--prefix", options.prefix, "Prefix of every channel name, so that several plants can share a bus")
      ->type_name("P");
  app.add_option("--log", options.log_path, "Write all published messages to an LCM log")->type_name("FILE");
  app.add_option("--csv", options.csv_path,
                 "Write the samples and the true values; without --lcm-url nothing is published")
      ->type_name("FILE");
  app.add_option("--report", options.report_path, "Write the score as JSON")->type_name("FILE");
  app.add_option("--inject", inject, "Faults to inject, comma separated")->type_name("KIND@PACK,...");
  app.add_option("--hide-effect", hide.effect, "Effects that the base equations lack: names, random, or none")
      ->type_name("NAME,...");
  app.add_option(
         "--effect-strength", hide.strength,
         "Gap ratio R of each: rms of what the refitted base parameters cannot absorb, divided by the standard\n"
         "deviation of the noise")
      ->type_name("R")
      ->capture_default_str();
  app.add_option("--effect-gate", hide.gate, "When they act: always, contact, free, from:S or until:S (seconds)")
      ->type_name("GATE");
  app.add_option("--sealed", hide.sealed_path, "Write the hidden effects to this file, as JSON for the scorer")
      ->type_name("FILE");

  return armcmc::support::RunProgram(app, "armcmc-plant", argc, argv, [&] {
    if (app.count("--inject") > 0) {
      try {
        options.faults = FaultPlan::Parse(inject);
      } catch (const std::invalid_argument& error) {
        throw InputError(std::string("--inject ") + error.what());
      }
    }
    CheckPrefix(options.prefix);
    if (stride->count() > 0 && options.stride < 1)
      throw InputError("--stride " + std::to_string(options.stride) + ": expected a number of samples, at least 1");
    if (!(recording.speed >= 1e-3 && recording.speed <= 1e6))
      throw InputError("--speed " + std::to_string(recording.speed) + ": expected a factor in [0.001, 1000000]");
    if (!recording.path.empty()) return Play(app, recording, options);
    Refuse(app, {"--data-dir"}, " needs --recording");
    std::optional<double> duration;
    if (app.count("--duration") > 0) {
      if (!std::isfinite(duration_s) || duration_s <= 0.0 || duration_s > 1e6)
        throw InputError("--duration " + std::to_string(duration_s) + ": expected seconds in (0, 1000000]");
      duration = duration_s;
    }
    if (!model_path.empty()) {
      Refuse(app, {"--hide-effect", "--sealed"},
             " contradicts --model: what a plant file does not know is [[hidden]] in its scenario");
      const auto plant_file = armcmc::plant_sim::PlantFileOf(model_path);
      if (plant_file) return Simulate(app, *plant_file, duration, recording.speed, options);
    }
    Refuse(app, {"--speed"}, " needs --recording, or a plant file as --model");
    Scenario scenario = armcmc::plant_sim::LoadScenario(armcmc::support::FindSharedFile("scenarios", scenario_name),
                                                        duration, options.seed);
    if (!model_path.empty()) armcmc::plant_sim::ApplyModelFile(model_path, &scenario);
    armcmc::plant_sim::CheckStride(options.stride, scenario.pack_samples);
    if (options.stride > 0) scenario.pack_stride = options.stride;
    if (scenario.num_packs() < 1)
      throw InputError("the duration of " + std::to_string(scenario.duration_s) + " s does not hold one pack of " +
                       std::to_string(scenario.pack_span_s()) + " s");
    const bool live = options.csv_path.empty() || url->count() > 0;
    if (!live && !options.report_path.empty())
      throw InputError("--report needs a live run: give --lcm-url, or leave --csv out");
    Hide(app, hide, options.seed, &scenario);
    return live ? armcmc::plant_sim::RunLive(scenario, options) : armcmc::plant_sim::RunOffline(scenario, options);
  });
}
