// Plants whose modes explain a target and that predict their output: an oven with a heater and a fan, and a thermometer
// that lags behind the air in it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "armcmc/ladder/diagnosis.hpp"
#include "armcmc/ladder/equations.hpp"
#include "armcmc/support/effect_library.hpp"
#include "armcmc/support/plant_file.hpp"

namespace armcmc::test::two_equations_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kOven = R"toml(schema = 1
name = "oven"
title = "Oven with a heater and a fan, and a slow thermometer"
output = "shown"
predicts = "glass"

[signals]
heat = { unit = "1", role = "drive" }
fan = { unit = "1", role = "drive" }
air = { unit = "K", role = "temperature" }
rise = { unit = "K/s", role = "temperature_rate", derivative_of = "air" }
shown = { unit = "K", role = "temperature" }

[constants]
wire = 700.0
room = 290.0
glass_s = 2.5

[parameters]
slow = { unit = "s", per_mode = true, mean = 30.0, sd = 30.0, lower = 1.0, upper = 500.0 }

[[mode]]
name = "heating"
when = "heat > 0"
target = "heat*(wire - air)"
law = "slow*rise"

[[mode]]
name = "cooling"
when = "fan > 0"
target = "fan*(room - air)"
law = "slow*rise"

[[mode]]
name = "off"
passive = true

[states]
inside = { unit = "K", role = "temperature", start = "air", rate = "if(heat > 0, heat*(wire - inside), if(fan > 0, fan*(room - inside), 0))/slow" }
glass = { unit = "K", role = "temperature", start = "shown", rate = "(inside - glass)/glass_s" }

[noise]
law = "gaussian"
std = 0.5
)toml";

struct Hidden {
  double lost = 0.0;                                                  ///< 1/s
  std::function<double(double t)> seen = [](double) { return 0.0; };  ///< K, on what the thermometer shows.
};

/// Three minutes at 20 Hz: the oven is heated to one level after the other, and cooled.
support::Recording Baked(const Plant& plant, const Hidden& hidden) {
  constexpr int kRows = 3600, kSteps = 10;
  constexpr double kDt = 0.05;
  support::Recording recording;
  const PlantDescription& description = plant.description();
  recording.title = "baked.csv";
  recording.model = recording.plant = description.name;
  recording.fingerprint = plant.fingerprint();
  recording.output = static_cast<std::size_t>(plant.output());
  recording.dt = kDt;
  recording.runs = {0};
  for (const SignalDescription& signal : description.signals)
    recording.signals.push_back({signal.name, signal.unit, {}});
  std::mt19937_64 random(17);
  std::normal_distribution<double> normal(0.0, 1.0);
  double air = 300.0, glass = 300.0;
  for (int n = 0; n < kRows; ++n) {
    const double t = kDt * n;
    const bool heats = std::fmod(t, 15.0) < 8.0;
    const double opening = 0.55 + 0.4 * std::sin(1.7 * std::floor(t / 5.0) + 0.4);
    const double heat = heats ? opening : 0.0, fan = heats ? 0.0 : opening;
    const auto rise = [&](double at) {
      return (heats ? heat * (700.0 - at) / 40.0 : fan * (290.0 - at) / 12.0) - hidden.lost * (at - 290.0);
    };
    const double row[] = {heat, fan, air + 0.05 * normal(random), rise(air) + 0.02 * normal(random),
                          glass + hidden.seen(t) + 0.1 * normal(random)};
    for (std::size_t s = 0; s < recording.signals.size(); ++s) recording.signals[s].value.push_back(row[s]);
    recording.t.push_back(t);
    recording.held_out.push_back(10 * n < 7 * kRows ? 0 : 1);
    for (int i = 0; i < kSteps; ++i) {
      glass += kDt / kSteps * (air - glass) / 2.5;
      air += kDt / kSteps * rise(air);
    }
  }
  return recording;
}

/// Diagnosed with a part of the catalogue, which takes less long.
ladder::Diagnosis Diagnosed(const Hidden& hidden, const std::string& oven = kOven) {
  const Plant plant = support::PlantFromText(oven, "oven.toml");
  const support::PlantFile file{plant.description(), plant, {}};
  const std::vector<std::string> tried = {"linear_loss",  "input_bias",           "output_bias",      "input_dead_band",
                                          "sensor_delay", "periodic_disturbance", "sensor_saturation"};
  ladder::DiagnosisRequest request;
  request.recording = Baked(plant, hidden);
  request.plant = &file;
  for (const EffectEntry& entry : support::ReadEffectLibrary())
    if (std::find(tried.begin(), tried.end(), entry.name) == tried.end()) request.without.push_back(entry.name);
  return ladder::Diagnose(request);
}

TEST(TwoEquations, LackNothingWhereNothingIsHidden) {
  const ladder::Diagnosis found = Diagnosed({});
  EXPECT_EQ(found.result.verdict, gap::Verdict::kNone) << found.result.sentence;
  EXPECT_THAT(found.result.ladder, IsEmpty());
  EXPECT_TRUE(found.result.complete);
}

TEST(TwoEquations, SayThatTheLawLacksALoss) {
  const ladder::Diagnosis found = Diagnosed({.lost = 0.004});
  ASSERT_EQ(found.result.ladder.size(), 1U) << found.result.sentence;
  EXPECT_THAT(found.result.ladder[0].effects, ElementsAre("linear_loss"));
  EXPECT_EQ(found.result.equation, "law");
  EXPECT_THAT(found.result.sentence, HasSubstr("Missing in the law: linear loss."));
  EXPECT_NEAR(found.result.effects[0].parameters.at(0).mean, 0.004, 0.0004);
  EXPECT_EQ(found.result.gap.unit, "K");
  // The whole plant with the loss, and not the law alone.
  EXPECT_EQ(found.after.plant.predicts, "glass");
  EXPECT_EQ(found.after.plant.modes.size(), 3U);
}

TEST(TwoEquations, SayThatThePredictionLacksARipple) {
  const ladder::Diagnosis found = Diagnosed({.seen = [](double t) { return 0.4 * std::sin(4.1 * t); }});
  ASSERT_EQ(found.result.ladder.size(), 1U) << found.result.sentence;
  EXPECT_THAT(found.result.ladder[0].effects, ElementsAre("periodic_disturbance"));
  EXPECT_EQ(found.result.equation, "prediction of shown");
  EXPECT_THAT(found.result.sentence, HasSubstr("Missing in the prediction of shown: periodic disturbance."));
  EXPECT_NEAR(found.result.gap.after.rmse, 0.1, 0.01);  // K, of what is shown
  // The whole plant predicts it, too.
  EXPECT_THAT(found.after.plant.predicts, HasSubstr("periodic_disturbance_A*sin("));
  EXPECT_EQ(found.after.plant.parameters.size(), 1U);
}

TEST(TwoEquations, SayBothWhereBothLackSomething) {
  const ladder::Diagnosis found = Diagnosed({.lost = 0.004, .seen = [](double t) { return 0.4 * std::sin(4.1 * t); }});
  std::vector<std::string> names;
  for (const gap::EffectFinding& effect : found.result.effects) names.push_back(effect.name);
  EXPECT_THAT(names, ::testing::UnorderedElementsAre("linear_loss", "periodic_disturbance"));
  EXPECT_THAT(found.result.sentence, HasSubstr("Missing in the law: linear loss."));
  EXPECT_THAT(found.result.sentence, HasSubstr("Missing in the prediction of shown: periodic disturbance."));
}

TEST(TwoEquations, NameNothingInAPredictionWhoseConstantsAreFarOff) {
  std::string oven = kOven;
  const std::string predicts = "predicts = \"glass\"";
  oven.replace(oven.find(predicts), predicts.size(), "predicts = \"1000*glass\"");
  const ladder::Diagnosis found = Diagnosed({}, oven);
  EXPECT_EQ(found.result.verdict, gap::Verdict::kUnnamed) << found.result.sentence;
  EXPECT_EQ(found.result.equation, "prediction of shown");
  EXPECT_THAT(found.result.notes, ::testing::Contains(HasSubstr("check the constants")));
  // What the law lacks is named all the same.
  EXPECT_EQ(Diagnosed({.lost = 0.004}, oven).result.effects.at(0).name, "linear_loss");
}

TEST(TwoEquations, ASignalStandsForTheStateThatItMeasures) {
  const PlantDescription oven = support::PlantFromText(kOven, "oven.toml").description();
  const std::vector<ladder::MeasuredState> measured = ladder::MeasuredStates(oven);
  ASSERT_EQ(measured.size(), 1U) << "the output is what is predicted";
  EXPECT_EQ(measured[0].state, "inside");
  EXPECT_EQ(measured[0].signal, "air");
  const auto output = ladder::OutputEquation(oven, measured, DefaultScales(oven), 0.1);
  ASSERT_TRUE(output);
  ASSERT_EQ(output->states.size(), 1U);
  EXPECT_EQ(output->states[0].name, "glass");
  ASSERT_EQ(output->parameters.size(), 1U) << "its start, which is measured with noise";
  EXPECT_EQ(output->parameters[0].name, "glass_start");
  EXPECT_TRUE(output->modes.empty());
  // Simulated, it needs what differs from mode to mode.
  const auto simulated = ladder::OutputEquation(oven, {}, DefaultScales(oven), 0.1);
  ASSERT_TRUE(simulated);
  EXPECT_EQ(simulated->states.size(), 2U);
  EXPECT_EQ(simulated->modes.size(), 3U);
  (void)Plant(*simulated);
}

TEST(TwoEquations, TheLawAloneHasNoStatesThatOnlyThePredictionReads) {
  const PlantDescription law = ladder::LawEquation(support::PlantFromText(kOven, "oven.toml").description());
  EXPECT_THAT(law.states, IsEmpty());
  EXPECT_THAT(law.predicts, IsEmpty());
  EXPECT_EQ(law.constants.size(), 2U) << "wire and room";
  (void)Plant(law);
}

}  // namespace
}  // namespace armcmc::test::two_equations_test
