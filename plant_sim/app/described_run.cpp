#include "described_run.hpp"

#include <algorithm>
#include <armcmc/support/csv.hpp>
#include <armcmc/support/pack_length.hpp>
#include <armcmc/support/plant_library.hpp>
#include <armcmc/support/printable.hpp>
#include <armcmc/support/program.hpp>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "armcmc/plant_sim/described_pack_builder.hpp"
#include "armcmc/plant_sim/described_pack_sender.hpp"
#include "armcmc/plant_sim/lcm_log_writer.hpp"
#include "described_files.hpp"
#include "play_runs.hpp"

namespace armcmc::plant_sim {
namespace {

namespace fs = std::filesystem;
using support::StrictTable;

void PrintDefaults(const DescribedPlant& plant, const DescribedScenario& scenario) {
  std::string moves;
  for (const auto& [name, program] : scenario.inputs) {
    char text[160];
    std::snprintf(text, sizeof(text), "%s%s %g +- %g %s up to %g Hz", moves.empty() ? "" : ", ", name.c_str(),
                  program.offset, program.amplitude,
                  plant.signals[static_cast<std::size_t>(plant.SignalAt(name))].unit.c_str(), program.bandwidth_hz);
    moves += text;
  }
  std::fprintf(stderr, "armcmc-plant: no scenario: the truth is the mean of the priors; multisines: %s\n",
               support::Printable(moves, 500).c_str());
}

/// The noise of a plant file is that of what its law explains, which need not be the output.
void LeaveOutNoiseOfTargets(const DescribedPlant& plant, DescribedScenario* scenario) {
  const bool targets = std::any_of(plant.modes.begin(), plant.modes.end(),
                                   [](const DescribedPlant::Mode& mode) { return !mode.target.empty(); });
  if (!targets || scenario->noise) return;
  scenario->noise = NoiseLaw{};
  std::fprintf(stderr,
               "armcmc-plant: %s explains a target, whose noise says nothing about %s: none is added; give "
               "[noise]\n",
               support::Printable(plant.name).c_str(), support::Printable(plant.output).c_str());
}

SampleRuns Simulate(const DescribedPlant& plant, const DescribedScenario& scenario) {
  constexpr double kMostRows = 2e7;
  const double rows = std::round(scenario.duration_s / scenario.dt);
  if (!(rows >= 1.0 && rows <= kMostRows))
    throw support::InputError("a duration of " + std::to_string(scenario.duration_s) + " s holds " +
                              std::to_string(rows) + " samples: expected 1 to 20 million");
  DescribedSimulation simulation(plant, scenario);
  SampleRuns runs;
  runs.plant = plant.name;
  runs.fingerprint = SignalFingerprint(plant);
  for (const DescribedPlant::Signal& signal : plant.signals) runs.signals.push_back({signal.name, signal.unit, {}});
  runs.output = static_cast<std::size_t>(plant.SignalAt(plant.output));
  runs.dt = scenario.dt;
  runs.runs = {0};
  for (auto left = static_cast<std::size_t>(rows); left > 0; --left) {
    simulation.Next();
    for (std::size_t s = 0; s < runs.signals.size(); ++s) {
      const double value = simulation.measured()[s];
      if (!std::isfinite(value))
        throw std::runtime_error(plant.name + ": " + runs.signals[s].name + " left the finite range at t = " +
                                 support::ExactNumber(simulation.t()) + " s: check truth, start and inputs");
      runs.signals[s].value.push_back(value);
    }
  }
  return runs;
}

void WriteCsv(const SampleRuns& runs, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  file << 't';
  for (const SignalSamples& signal : runs.signals) file << ',' << signal.name;
  file << '\n';
  for (std::size_t row = 0; row < runs.num_rows(); ++row) {
    file << support::ExactNumber(static_cast<double>(row) * runs.dt);
    for (const SignalSamples& signal : runs.signals) file << ',' << support::ExactNumber(signal.value[row]);
    file << '\n';
  }
  if (!file.flush()) throw std::runtime_error(path + ": cannot be written");
}

/// Without a clock: packs are stamped with the plant's time.
void WriteDescribedLog(const SampleRuns& runs, int samples_per_pack, std::uint64_t seed, const PlantOptions& options) {
  LcmLogWriter log(options.log_path);
  CheckStride(options.stride, samples_per_pack);
  DescribedPackBuilder builder(runs, samples_per_pack, static_cast<std::int64_t>(seed), options.stride);
  DescribedPackSender sender(options.prefix, &log, nullptr);
  for (std::int64_t k = 1; builder.Next(); ++k) {
    const std::int64_t t_ns = std::llround(static_cast<double>(k) * builder.pack_period_s() * 1e9);
    builder.Stamp(t_ns, t_ns / 1000);
    sender.Send(builder.pack());
  }
  if (log.errors() > 0) throw std::runtime_error(options.log_path + ": cannot be written: is the disk full?");
}

}  // namespace

std::optional<fs::path> PlantFileOf(const std::string& model) {
  std::error_code error;
  if (!fs::is_regular_file(model, error)) return support::FindPlantFile(model);
  if (StrictTable::FromFile(model).Has("signals")) return model;
  return std::nullopt;
}

int RunDescribed(const fs::path& plant_file, const DescribedRequest& request, const PlantOptions& options) {
  const StrictTable plant_table = StrictTable::FromFile(plant_file);
  const DescribedPlant plant = ReadDescribedPlant(plant_table);
  std::optional<StrictTable> scenario_table;
  DescribedScenario scenario;
  if (request.scenario.empty()) {
    scenario = UsualScenario(plant);
    PrintDefaults(plant, scenario);
  } else {
    scenario_table = StrictTable::FromFile(request.scenario);
    scenario = ReadDescribedScenario(*scenario_table);
  }
  scenario.duration_s = request.duration_s.value_or(scenario.duration_s);
  scenario.seed = request.seed.value_or(scenario.seed);
  LeaveOutNoiseOfTargets(plant, &scenario);
  SampleRuns runs;
  try {
    runs = Simulate(plant, scenario);
  } catch (const DescribedError& error) {
    throw Placed(error, plant_table, scenario_table ? &*scenario_table : nullptr);
  }
  if (!options.csv_path.empty()) WriteCsv(runs, options.csv_path);
  const int samples = support::SuitablePackLength(runs.dt, data_pack_v2_t::MAX_SAMPLES);
  PlantOptions packs = options;
  if (packs.stride == 0) packs.stride = scenario.pack_stride;
  if (request.live) return PlayRuns(runs, plant.name, samples, request.speed, packs);
  if (!options.log_path.empty()) WriteDescribedLog(runs, samples, scenario.seed, packs);
  std::printf("%s: %zu samples written to %s\n", support::Printable(plant.name).c_str(), runs.num_rows(),
              support::Escaped(options.csv_path).c_str());
  return 0;
}

}  // namespace armcmc::plant_sim
