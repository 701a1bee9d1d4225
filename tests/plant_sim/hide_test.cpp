#include "armcmc/plant_sim/effects/hide.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "armcmc/plant_sim/effects/gap_meter.hpp"
#include "builtin_scenario.hpp"
#include "samples.hpp"

namespace armcmc::plant_sim::hide_test {
namespace {

/// The paper's contact, short.
Scenario Short() {
  Scenario scenario = BuiltinScenario("hunt_crossley_paper");
  scenario.duration_s = 8.0;
  return scenario;
}

/// For gaps that are proportional to their strength, and for none: a search is as long as it has samples to refit.
Scenario Coarse(Scenario scenario) {
  scenario.sample_interval_s = 0.005;
  scenario.pack_samples = 20;
  return scenario;
}

EffectRequest Request(const std::string& name, const std::string& variant, double gap_ratio) {
  EffectRequest request;
  request.name = name;
  request.variant = variant;
  request.gap_ratio = gap_ratio;
  return request;
}

TEST(GapMeter, SeesNothingInWhatTheBaseParametersAbsorb) {
  const Scenario scenario = Short();
  const std::unique_ptr<GapMeter> meter = MakeGapMeter(scenario);
  EXPECT_LT(meter->GapRatio({}), 1e-9);
  // A stiffness that is another from the start is just another K.
  EffectRequest request = Request("stiffness_drift", "exponential", 1.0);
  request.values = {{"share", 0.4}, {"tau", 1e-9}};
  EXPECT_LT(DecideEffects(scenario, {request}, 1)[0].gap_ratio, 1e-3);
}

TEST(GapMeter, MeasuresWhatAConstantLeaves) {
  // Out of contact a bias is seen whole, in contact a part of it is absorbed.
  EffectRequest request = Request("force_bias", "", 1.0);
  request.values = {{"force", 0.1}};
  request.gate = Gate::Parse("free");
  const Scenario scenario = Short();
  int free_samples = 0;
  for (const PlantSample& sample : TrueSamples(scenario, 8001)) free_samples += sample.mode;
  EXPECT_NEAR(DecideEffects(scenario, {request}, 1)[0].gap_ratio, std::sqrt(free_samples / 8001.0), 1e-6);
}

TEST(Hide, TheStrengthGivesTheGapRatioOfEveryEffect) {
  const Scenario scenario = Short();
  const std::unique_ptr<GapMeter> meter = MakeGapMeter(scenario);
  constexpr double kGapRatio = 0.3;
  for (const EffectSpec& spec : EffectRegistry(*scenario.family)) {
    const std::vector<HiddenEffect> effects = DecideEffects(scenario, {Request(spec.name, spec.variant, kGapRatio)}, 3);
    ASSERT_EQ(effects.size(), 1u);
    EXPECT_NEAR(meter->GapRatio(effects), kGapRatio, 0.05 * kGapRatio) << spec.name << ":" << spec.variant;
  }
}

TEST(Hide, InTheAirOnlyEffectsThatAreFeltThereCanBeHidden) {
  const Scenario scenario = Coarse(BuiltinScenario("experiment_free_air_chirp"));
  for (const char* name : {"inertia", "force_bias", "force_drift", "viscous_friction", "coulomb_friction",
                           "presliding_friction", "periodic_disturbance"})
    EXPECT_NEAR(DecideEffects(scenario, {Request(name, "", 3.0)}, 1)[0].gap_ratio, 3.0, 0.031) << name;
  for (const char* name :
       {"adhesion", "stress_relaxation", "stiffness_drift", "sensor_delay", "sensor_lag", "sensor_saturation"})
    EXPECT_THROW((void)DecideEffects(scenario, {Request(name, "", 3.0)}, 1), std::invalid_argument) << name;
}

TEST(Hide, TheGapRatioCountsANoiseThatGrowsByItsRms) {
  Scenario scenario = Short();
  EffectRequest request = Request("viscous_friction", "linear", 1.0);
  request.values = {{"damping", 0.5}};
  const double plain = DecideEffects(scenario, {request}, 1)[0].gap_ratio;
  double sum = 0.0;
  for (const PlantSample& sample : TrueSamples(scenario, 8001)) {
    const double factor = 1.0 + 2.0 * std::abs(sample.output) / 1.5;
    sum += factor * factor / 8001;
  }
  scenario.noise.back().growth = 2.0;
  scenario.noise.back().reference = 1.5;
  EXPECT_NEAR(DecideEffects(scenario, {request}, 1)[0].gap_ratio, plain / std::sqrt(sum), 1e-9 * plain);
}

TEST(Hide, FindsStrengthsWhateverTheSizeAndTheMotionOfTheContact) {
  for (const char* name : {"contact_rich_mm", "contact_sine"}) {
    const Scenario scenario = BuiltinScenario(name);
    for (const EffectSpec& spec : EffectRegistry(*scenario.family)) {
      const HiddenEffect effect = DecideEffects(scenario, {Request(spec.name, spec.variant, 0.5)}, 3).front();
      EXPECT_NEAR(effect.gap_ratio, 0.5, 0.0051) << name << " " << spec.name << ":" << spec.variant;
    }
  }
}

TEST(Hide, TheDrawIsTheSameForASeedAndComesToEverythingOverSeeds) {
  Scenario scenario = Short();
  scenario.duration_s = 7.0;
  scenario.sample_interval_s = 0.01;
  scenario.pack_samples = 10;
  std::map<HiddenKind, int> kinds;
  std::set<std::string> names, gates, forms;
  constexpr int kSeeds = 200;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const std::vector<HiddenEffect> effects = DrawEffects(scenario, 1.0, {}, seed);
    if (seed <= 10) {
      const std::vector<HiddenEffect> again = DrawEffects(scenario, 1.0, {}, seed);
      ASSERT_EQ(again.size(), effects.size());
      for (std::size_t i = 0; i < effects.size(); ++i) {
        EXPECT_EQ(again[i].spec, effects[i].spec);
        EXPECT_EQ(again[i].values, effects[i].values);
        EXPECT_EQ(again[i].gate.Text(), effects[i].gate.Text());
      }
    }
    ++kinds[KindOf(effects)];
    for (const HiddenEffect& effect : effects) {
      EXPECT_NEAR(effect.gap_ratio, 1.0, 0.05) << effect.spec->name;
      names.insert(effect.spec->name);
      forms.insert(FormulaKindName(effect.spec->kind));
      gates.insert(effect.gate.Text().substr(0, 4));
    }
    if (effects.size() == 2) {
      EXPECT_NE(effects[0].spec->name, effects[1].spec->name);
    }
  }
  for (const HiddenKind kind : {HiddenKind::kNone, HiddenKind::kSingle, HiddenKind::kPair, HiddenKind::kOutside})
    EXPECT_NEAR(kinds[kind], 0.25 * kSeeds, 0.1 * kSeeds) << HiddenKindName(kind);
  EXPECT_EQ(names.size(), EffectNames(*scenario.family).size());
  EXPECT_EQ(gates, (std::set<std::string>{"alwa", "cont", "free", "from", "unti"}));
  EXPECT_EQ(forms.size(), 3u);
}

TEST(Hide, NamesWhatIsWrongWithARequest) {
  const Scenario scenario = Coarse(Short());
  const auto problem = [&scenario](const std::string& text, double gap_ratio = 1.0) -> std::string {
    try {
      static_cast<void>(DecideEffects(scenario, ParseEffectRequests(text, {}, gap_ratio), 1));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(problem("gremlin").find("coulomb_friction"), std::string::npos);
  EXPECT_NE(problem("coulomb_friction:wet").find("stribeck"), std::string::npos);
  EXPECT_NE(problem("inertia,inertia").find("twice"), std::string::npos);
  EXPECT_NE(problem("inertia,force_bias,adhesion").find("at most two"), std::string::npos);
  EXPECT_NE(problem("inertia,").find("NAME"), std::string::npos);
  EXPECT_NE(problem("sensor_saturation", 900.0).find("cannot reach"), std::string::npos);
  EXPECT_THROW(
      (void)DecideEffects(BuiltinScenario("soft_actuator_excited"), ParseEffectRequests("inertia", {}, 1.0), 1),
      std::invalid_argument);
}

}  // namespace
}  // namespace armcmc::plant_sim::hide_test
