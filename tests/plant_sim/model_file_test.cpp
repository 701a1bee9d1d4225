// The plant of a model file against what the estimator's composed model predicts from the same file. The two share no
// equation.

#include "model_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <armcmc/support/model_file.hpp>
#include <armcmc/support/strict_toml.hpp>
#include <cmath>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/effects/composition.hpp"
#include "armcmc/models/registry.hpp"
#include "builtin_scenario.hpp"
#include "plants/hunt_crossley/effects.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "plants/soft_actuator/effects.hpp"
#include "plants/soft_actuator/model.hpp"
#include "samples.hpp"
#include "simd/kernels.hpp"
#include "support/paths.hpp"

namespace armcmc::plant_sim::model_file_test {
namespace {

using support::ConfigError;
using testing::HasSubstr;

constexpr int kPack = 100, kPacks = 40;

/// An effect of the estimator's catalogue at values that show on contact_rich, whose forces are tenths of a newton.
struct Case {
  std::string name;
  std::vector<double> amplitudes, shapes;
  double tolerance = 1e-9;  ///< Of the largest force.
  EffectGate gate = EffectGate::kAlways;
};

std::vector<Case> AllCases() {
  return {{"force_bias", {-0.05}, {}},
          {"force_drift", {0.02}, {1.5}},
          {"coulomb_friction", {0.05}, {0.1}},
          {"presliding_friction", {0.05}, {0.01}},
          {"viscous_friction", {0.06}, {}},
          // Differences of first and of second order of the speed: x''' dt / 2 apart.
          {"inertia", {0.003}, {0.0}, 0.1},
          {"sensor_delay", {0.0123}, {}},
          {"sensor_lag", {0.008}, {}},
          {"stress_relaxation", {1.0}, {0.3}},
          {"adhesion", {0.1}, {0.05}},
          {"contact_offset", {0.03}, {}},
          {"sensor_saturation", {0.3}, {}},
          {"periodic_disturbance", {0.03, -0.04}, {7.0}},
          {"stiffness_drift", {0.1}, {0.5}}};
}

ParameterSettings At(ParameterSettings prior, double mean) {
  prior.prior = PriorKind::kNormal;
  prior.mean = mean;
  prior.lower = std::min(prior.lower, mean);
  prior.upper = std::max(prior.upper, mean);
  return prior;
}

EstimatorSettings Model(const std::vector<Case>& cases) {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  const double base[] = {5.0, 1.1, 1.6};
  for (std::size_t d = 0; d < 3; ++d) settings.parameters[d] = At(settings.parameters[d], base[d]);
  for (const Case& one : cases) {
    EffectSettings& effect = settings.effects[static_cast<std::size_t>(settings.num_effects++)];
    effect = armcmc::MakeEffect(HuntCrossley::kInfo, one.name);
    effect.gate = one.gate;
    effect.from_s = effect.until_s = 1.2345;
    for (std::size_t a = 0; a < one.amplitudes.size(); ++a)
      effect.amplitudes[a] = At(effect.amplitudes[a], one.amplitudes[a]);
    std::copy(one.shapes.begin(), one.shapes.end(), effect.shapes.begin());
  }
  return settings;
}

/// contact_rich without noise, the plant of a model file in it.
Scenario WithModel(const std::string& text) {
  const test::ScratchDir folder;
  const std::filesystem::path path = folder / "model.toml";
  std::ofstream(path) << text;
  Scenario scenario = NoiselessScenario("contact_rich");
  ApplyModelFile(path, &scenario);
  return scenario;
}

std::vector<PlantSample> Simulated(const EstimatorSettings& settings) {
  return MeasuredSamples(WithModel(support::ModelFileText(settings)), kPack * kPacks);
}

std::vector<double> Predict(const EstimatorSettings& settings, const std::vector<PlantSample>& samples) {
  Composition composition(settings);
  const auto effects = std::make_unique<EffectPack>(composition.MakePack());
  const auto data = std::make_unique<ModeData>();
  const auto tile = std::make_unique<PredictionTile>();
  ThetaTile theta{};
  for (std::size_t d = 0; d < static_cast<std::size_t>(composition.sampled().num_parameters); ++d)
    theta.value[d].fill(composition.sampled().parameters[d].mean);
  std::vector<double> predicted;
  for (std::size_t first = 0; first < samples.size(); first += kPack) {
    DataPack pack;
    pack.seq = static_cast<std::int64_t>(first / kPack) + 1;
    pack.run_id = 1;
    pack.dt = 1e-3;
    pack.plant = HuntCrossley::kInfo.plant;
    pack.num_samples = kPack;
    pack.num_inputs = 2;
    for (std::size_t n = 0; n < kPack; ++n) pack.u[n] = {samples[first + n].inputs[0], samples[first + n].inputs[1]};
    pack.t_last_s = samples[first + kPack - 1].t_s;
    EXPECT_TRUE(composition.Prepare(pack, effects.get()));
    composition.Fill(pack, *effects, 0, data.get());
    simd::kPortableKernels.predict(FindModel("hunt_crossley"), *data, theta, tile.get());
    for (std::size_t n = 0; n < kPack; ++n) predicted.push_back(tile->value[n][0]);
  }
  return predicted;
}

double Largest(const std::vector<PlantSample>& samples, const std::function<double(std::size_t)>& reference) {
  double largest = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i)
    largest = std::max(largest, std::abs(samples[i].output - reference(i)));
  return largest;
}

/// @return what the plant does.
std::vector<PlantSample> ExpectSamePrediction(const std::vector<Case>& cases, double tolerance,
                                              const std::string& what) {
  const EstimatorSettings settings = Model(cases);
  std::vector<PlantSample> samples = Simulated(settings);
  const std::vector<double> predicted = Predict(settings, samples);
  const double force = Largest(samples, [](std::size_t) { return 0.0; });
  EXPECT_GT(force, 0.1);
  EXPECT_LT(Largest(samples, [&](std::size_t i) { return predicted[i]; }), tolerance * force) << what;
  return samples;
}

TEST(ModelFile, ThePlantDoesWhatTheEstimatorPredictsForEveryEffect) {
  const std::vector<PlantSample> base = Simulated(Model({}));
  std::vector<std::string> names, catalogue;
  for (const Case& one : AllCases()) {
    const std::vector<PlantSample> samples = ExpectSamePrediction({one}, one.tolerance, one.name);
    EXPECT_GT(Largest(samples, [&](std::size_t i) { return base[i].output; }), 1e-3) << one.name << " does nothing";
    names.push_back(one.name);
  }
  for (const EffectInfo* info : ContactEffects::kInfos) catalogue.emplace_back(info->name);
  EXPECT_THAT(names, testing::UnorderedElementsAreArray(catalogue));
}

TEST(ModelFile, TheEstimatorsInertiaIsThePlantsHalfASampleEarlier) {
  const Case inertia{"inertia", {0.003}, {0.0}};
  const std::vector<PlantSample> base = Simulated(Model({})), at = Simulated(Model({inertia}));
  const std::vector<double> predicted = Predict(Model({inertia}), at);
  double worst = 0.0, most = 0.0;
  for (std::size_t i = 3; i < at.size(); ++i) {
    const double now = at[i].output - base[i].output, before = at[i - 1].output - base[i - 1].output;
    worst = std::max(worst, std::abs(predicted[i] - base[i].output - 0.5 * (now + before)));
    most = std::max(most, std::abs(now));
  }
  EXPECT_LT(worst, 0.02 * most);  // (2 pi 30 Hz dt)^2 / 2
}

TEST(ModelFile, AlsoThroughGates) {
  for (const EffectGate gate : {EffectGate::kContact, EffectGate::kFree, EffectGate::kFrom, EffectGate::kUntil}) {
    for (Case one : AllCases()) {
      one.gate = gate;
      ExpectSamePrediction({one}, one.tolerance, one.name + " gate " + std::to_string(static_cast<int>(gate)));
    }
  }
}

TEST(ModelFile, AlsoForEffectsTogether) {
  const auto named = [](const std::string& name) {
    const std::vector<Case> cases = AllCases();
    return *std::find_if(cases.begin(), cases.end(), [&name](const Case& one) { return one.name == name; });
  };
  ExpectSamePrediction({named("sensor_saturation"), named("sensor_lag"), named("coulomb_friction"),
                        named("sensor_delay"), named("contact_offset")},
                       1e-9, "in every slot");
  ExpectSamePrediction({named("stiffness_drift"), named("stress_relaxation"), named("force_bias"), named("adhesion"),
                        named("presliding_friction")},
                       1e-9, "five");
}

TEST(ModelFile, TheTruthIsTheBaseOfTheFileAndWhatItLeavesOutIsTheScenarios) {
  const Scenario all = WithModel(support::ModelFileText(Model({})));
  EXPECT_EQ(all.schedule.Value(0, 0.0), 5.0);
  EXPECT_EQ(all.schedule.Value(1, 0.0), 1.1);
  EXPECT_EQ(all.schedule.Value(2, 0.0), 1.6);
  EXPECT_TRUE(all.hidden.empty());
  const Scenario some = WithModel("schema = 1\nbase = \"hunt_crossley\"\n[parameters.p]\nmean = 1.3\n");
  EXPECT_EQ(some.schedule.Value(0, 0.0), BuiltinScenario("contact_rich").schedule.Value(0, 0.0));
  EXPECT_EQ(some.schedule.Value(2, 0.0), 1.3);
}

TEST(ModelFile, ANoiseThatIsAShareOfTheForceFollowsTheNewPlant) {
  const test::ScratchDir folder;
  std::ofstream(folder / "m.toml") << "schema = 1\nbase = \"hunt_crossley\"\n[parameters.K]\nmean = 400.0\n"
                                   << "[parameters.B]\nmean = 0.0\n[parameters.p]\nmean = 1.0\n";
  Scenario scenario = BuiltinScenario("contact_rich");
  const double before = scenario.noise.back().std;
  ApplyModelFile(folder / "m.toml", &scenario);
  EXPECT_GT(scenario.noise.back().std, 10.0 * before);
  EXPECT_EQ(scenario.noise.back().std, 0.01 * scenario.noise.back().reference);
}

TEST(ModelFile, SaysWhatIsWrongWithAFile) {
  const auto problem = [](const std::string& text) -> std::string {
    try {
      static_cast<void>(WithModel("schema = 1\nbase = \"hunt_crossley\"\n" + text));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(problem(""), "accepted");
  EXPECT_THAT(problem("[[effect]]\nname = \"gremlin\"\n"), HasSubstr("coulomb_friction"));
  EXPECT_THAT(problem("[[effect]]\nname = \"force_bias\"\n"), HasSubstr("effect[0].force: missing"));
  EXPECT_THAT(problem("[[effect]]\nname = \"force_bias\"\nforce = { mean = 1.0, std = 2.0 }\n"), HasSubstr("std"));
  EXPECT_THAT(problem("[[effect]]\nname = \"force_bias\"\nforce = { prior = \"uniform\", lower = 0.0, upper = 1.0 }\n"),
              HasSubstr("has no mean"));
  EXPECT_THAT(problem("[[effect]]\nname = \"coulomb_friction\"\nforce = { mean = 1.0 }\n"),
              HasSubstr("speed is missing"));
  EXPECT_THAT(problem("[[effect]]\nname = \"sensor_delay\"\ntime = { mean = 0.0 }\n"), HasSubstr("positive delay"));
  EXPECT_THAT(problem("[[effect]]\nname = \"force_bias\"\nforce = { mean = 1.0 }\nwhen = \"free\"\nfrom_s = 1.0\n"),
              HasSubstr("not both"));
  const std::string bias = "[[effect]]\nname = \"force_bias\"\nforce = { mean = 1.0 }\n";
  EXPECT_THAT(problem(bias + bias), HasSubstr("twice"));
  EXPECT_THAT(problem("[parameters.p]\nmean = 20.0\n"), HasSubstr("cannot be at 20"));
  EXPECT_THAT(problem("[parameters.K]\nprior = \"uniform\"\nlower = 1.0\nupper = 2.0\n"), HasSubstr("has no mean"));
  EXPECT_THAT(problem("[parameters.Q]\nmean = 1.0\n"), HasSubstr("parameters.Q"));
}

// The flow's effects: what the plant measures, without noise, is what the estimator's law says at the truth.
struct FlowCase {
  std::string name;
  double amplitude;
};

std::vector<FlowCase> FlowCases() {
  return {{"pressure_bias", -3e3},
          {"valve_lag", 0.002},
          {"valve_dead_band", 0.004},
          {"supply_droop", 1.5e6},
          {"leak", 0.05}};
}

EstimatorSettings ActuatorModel(const std::vector<FlowCase>& cases, double from_s) {
  EstimatorSettings settings = BuiltinSettings("soft_actuator_excited");
  for (const FlowCase& one : cases) {
    EffectSettings& effect = settings.effects[static_cast<std::size_t>(settings.num_effects++)];
    effect = armcmc::MakeEffect(SoftActuator::kInfo, one.name);
    effect.amplitudes[0] = At(effect.amplitudes[0], one.amplitude);
    effect.amplitudes[0].upper = std::max(effect.amplitudes[0].mean * 2.0, 0.0) + 1e-6;
    effect.gate = from_s > 0.0 ? EffectGate::kFrom : EffectGate::kAlways;
    effect.from_s = from_s;
  }
  return settings;
}

/// Largest difference of the pressure rates, as a share of the largest.
double WorstFlow(const std::vector<FlowCase>& cases, double from_s) {
  const EstimatorSettings settings = ActuatorModel(cases, from_s);
  const test::ScratchDir folder;
  std::ofstream(folder / "m.toml") << support::ModelFileText(settings, "soft_actuator_excited");
  Scenario scenario = NoiselessScenario("soft_actuator_excited");
  ApplyModelFile(folder / "m.toml", &scenario);
  EXPECT_EQ(scenario.hidden.size(), cases.size());
  const std::vector<PlantSample> samples = MeasuredSamples(scenario, kPack * kPacks);
  Composition composition(settings);
  const auto effects = std::make_unique<EffectPack>(composition.MakePack());
  const auto data = std::make_unique<ModeData>();
  const auto tile = std::make_unique<PredictionTile>();
  ThetaTile theta{};
  for (std::size_t d = 0; d < static_cast<std::size_t>(composition.sampled().num_parameters); ++d)
    theta.value[d].fill(composition.sampled().parameters[d].mean);
  double worst = 0.0, largest = 0.0;
  int compared = 0;
  for (std::size_t first = 0; first < samples.size(); first += kPack) {
    DataPack pack;
    pack.seq = static_cast<std::int64_t>(first / kPack) + 1;
    pack.run_id = 1;
    pack.dt = 1e-3;
    pack.plant = SoftActuator::kInfo.plant;
    pack.num_samples = kPack;
    pack.num_inputs = 4;
    for (std::size_t n = 0; n < kPack; ++n)
      for (std::size_t i = 0; i < 4; ++i) pack.u[n][i] = samples[first + n].inputs[i];
    pack.t_last_s = samples[first + kPack - 1].t_s;
    EXPECT_TRUE(composition.Prepare(pack, effects.get()));
    for (int mode = 0; mode < 2; ++mode) {
      composition.Fill(pack, *effects, mode, data.get());
      const std::size_t m = mode == 0 ? 0 : 2;
      const double slope = scenario.schedule.Value(static_cast<int>(m) + 1, 0.0);
      theta.value[0].fill(scenario.schedule.Value(static_cast<int>(m), 0.0) + slope * ConstantOf(settings, "p_atm"));
      theta.value[1].fill(slope);
      simd::kPortableKernels.predict(FindModel("soft_actuator"), *data, theta, tile.get());
      for (std::size_t k = 0; k < static_cast<std::size_t>(data->num_samples); ++k, ++compared) {
        const double measured = data->target[k];
        worst = std::max(worst, std::abs(tile->value[k][0] - measured));
        largest = std::max(largest, std::abs(measured));
      }
    }
  }
  EXPECT_GT(compared, 1500);
  return worst / largest;
}

TEST(ModelFile, TheActuatorDoesWhatTheEstimatorPredictsForEveryEffectOfItsFlow) {
  std::vector<std::string> names, online;
  for (const FlowCase& one : FlowCases()) {
    EXPECT_LT(WorstFlow({one}, 0.0), 1e-9) << one.name;
    EXPECT_LT(WorstFlow({one}, 1.2345), 1e-9) << one.name << " from 1.2345 s";
    names.push_back(one.name);
  }
  for (const EffectInfo* info : FlowEffects::kInfos) online.emplace_back(info->name);
  EXPECT_THAT(names, testing::UnorderedElementsAreArray(online));
}

TEST(ModelFile, TheActuatorsEffectsActInTheEstimatorsOrderWhateverThatOfTheFile) {
  std::vector<FlowCase> cases = FlowCases();
  EXPECT_LT(WorstFlow(cases, 0.0), 1e-9);
  std::reverse(cases.begin(), cases.end());
  EXPECT_LT(WorstFlow(cases, 0.0), 1e-9);
}

TEST(ModelFile, SaysWhyItDoesNotFitAScenario) {
  const test::ScratchDir folder;
  const auto problem = [&folder](const std::string& base, const std::string& name) -> std::string {
    std::ofstream(folder / "m.toml") << "schema = 1\nbase = \"" << base << "\"\n";
    Scenario scenario = BuiltinScenario(name);
    try {
      ApplyModelFile(folder / "m.toml", &scenario);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(problem("hunt_crossley", "hunt_crossley_paper"), "accepted");
  EXPECT_EQ(problem("soft_actuator_excited", "soft_actuator_excited"), "accepted");
  EXPECT_THAT(problem("tank", "soft_actuator_paper"), HasSubstr("cannot become a plant"));
  EXPECT_THAT(problem("hunt_crossley", "soft_actuator_paper"), HasSubstr("does not fit"));
  EXPECT_THAT(problem("soft_actuator", "hunt_crossley_paper"), HasSubstr("does not fit"));
  EXPECT_THAT(problem("hunt_crossley", "hunt_crossley_step"), HasSubstr("[[change]]"));
}

}  // namespace
}  // namespace armcmc::plant_sim::model_file_test
