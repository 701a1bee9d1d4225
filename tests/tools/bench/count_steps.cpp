// Runs so many steps of one case over fixed packs, for a counter of instructions that stands beside it.
//
//   count_steps CASE STEPS
//
// Prints the instruction set that it ran on.

#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>

#include "armcmc/adjust_result.hpp"
#include "armcmc/bench/press.hpp"
#include "armcmc/bench/workload.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/models/registry.hpp"
#include "armcmc/plant/program.hpp"

namespace {

using namespace armcmc;  // NOLINT(google-build-using-namespace): a program of one file

constexpr int kSamples = 100;

/// Waves about 1, each signal at a frequency of its own: what a law makes of them takes as long as any data.
DataPack Waves(const Estimator& estimator, const EstimatorSettings& settings, int index) {
  constexpr double kDt = 1e-3;
  DataPack pack;
  pack.seq = index + 1;
  pack.run_id = 1;
  pack.dt = kDt;
  pack.plant = estimator.plant();
  pack.fingerprint = settings.plant->plant().fingerprint();
  pack.num_samples = kSamples;
  pack.num_inputs = estimator.num_inputs();
  for (int n = 0; n < kSamples; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const double t = kDt * (index * kSamples + n);
    for (int j = 0; j < pack.num_inputs; ++j)
      pack.u[i][static_cast<std::size_t>(j)] = 1.0 + 0.5 * std::sin((7.0 + 3.0 * j) * t);
    pack.y[i] = 1.0 + 0.5 * std::sin(5.0 * t);
    pack.t_last_s = t;
  }
  return pack;
}

struct Case {
  EstimatorSettings settings;
  bool press = true;
};

Case MakeCase(const std::string& name) {
  const std::string& contact = bench::PressedPlant();
  Case made{BuiltinSettings(contact), true};
  for (NoiseSettings& noise : made.settings.noise) noise.std = bench::Press().noise;
  if (name == "press") return made;
  if (name == "press_every_sample") {
    made.settings.sampler.use_linearity = false;
  } else if (name == "press_mixture") {
    for (NoiseSettings& noise : made.settings.noise) noise.kind = NoiseKind::kMixture;
  } else if (name == "press_effects") {
    const ModelInfo& info = *CompiledModels()[static_cast<std::size_t>(FindModel(contact))];
    for (const char* effect : {"coulomb_friction", "sensor_lag"})
      made.settings.effects[static_cast<std::size_t>(made.settings.num_effects++)] = MakeEffect(info, effect);
  } else if (name == "press_tape") {
    for (const bench::Plant& plant : bench::KnownPlants())
      if (plant.name == contact + ":tape") made.settings = bench::SettingsOf(plant);
    for (NoiseSettings& noise : made.settings.noise) noise.std = bench::Press().noise;
  } else if (name.starts_with("waves_")) {
    const std::string plant = name.substr(6);
    made = {bench::SettingsOf({plant, plant}), false};
  } else {
    throw std::invalid_argument(name + ": no such case");
  }
  return made;
}

void Run(const std::string& name, int steps) {
  const Case what = MakeCase(name);
  Estimator estimator(what.settings);
  const auto result = estimator.MakeResult();
  Estimate estimate;
  for (int k = 0; k < steps; ++k) {
    DataPack pack = what.press ? bench::MakePress(bench::Press(), k, kSamples, 1) : Waves(estimator, what.settings, k);
    if (what.press && what.settings.plant != nullptr) {
      pack.plant = estimator.plant();
      pack.fingerprint = what.settings.plant->plant().fingerprint();
    }
    const Status status = estimator.Adjust(pack, std::numeric_limits<Nanos>::max(), ClockRef(), result.get());
    if (status != Status::kOk) throw std::runtime_error(name + ": a pack was not used");
    estimator.Execute(*result, &estimate);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 3) throw std::invalid_argument("usage: count_steps CASE STEPS");
    std::fprintf(stderr, "instruction set %s\n", std::string(InstructionSet()).c_str());
    Run(argv[1], std::stoi(argv[2]));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "count_steps: %s\n", error.what());
    return 1;
  }
}
