// Effects inside the soft actuator and on its sensors, each against what its formula says. Those of the flow are
// compared with the estimator's in model_file_test.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "armcmc/plant_sim/effects/gap_meter.hpp"
#include "armcmc/plant_sim/effects/hide.hpp"
#include "builtin_scenario.hpp"
#include "samples.hpp"

namespace armcmc::plant_sim::actuator_effects_test {
namespace {

constexpr double kPAtm = 101'325.0, kQ1 = 0.0704, kQ2 = 132.28, kQ3 = 3319.4;

using Values = std::vector<double>;

/// Four seconds of the excited actuator, without noise, with one effect; of no name: with none.
std::vector<PlantSample> WithEffect(const std::string& name, const Values& values, const Gate& gate = {}) {
  Scenario scenario = NoiselessScenario("soft_actuator_excited");
  scenario.duration_s = 4.0;
  for (const EffectSpec& spec : EffectRegistry(*scenario.family))
    if (spec.name == name) scenario.hidden = {HiddenEffect{&spec, values, gate, 0.0}};
  return MeasuredSamples(scenario, 4001);
}

TEST(ActuatorEffects, BendEffectsChangeTheAccelerationByTheirFormula) {
  // What the angle's second difference says beside the base equation, against the formula of (t, alpha, alpha', base).
  using Formula = std::function<double(double, double, double, double)>;
  const auto expect = [](const std::string& name, const Values& values, const Formula& formula) {
    const std::vector<PlantSample> s = WithEffect(name, values);
    double error_sq = 0.0, sum_sq = 0.0;
    for (std::size_t i = 1; i + 1 < s.size(); ++i) {
      const double rate = (s[i + 1].output - s[i - 1].output) / 2e-3;
      const double acceleration = (s[i + 1].output - 2.0 * s[i].output + s[i - 1].output) / 1e-6;
      const double base = kQ1 * (s[i].inputs[2] - kPAtm) - kQ2 * rate - kQ3 * s[i].output;
      const double says = formula(s[i].t_s, s[i].output, rate, base);
      error_sq += std::pow(acceleration - base - says, 2.0);
      sum_sq += says * says;
    }
    EXPECT_GT(sum_sq, 1.0) << name;
    EXPECT_LT(std::sqrt(error_sq / sum_sq), 0.05) << name;
  };
  expect("joint_friction", {400.0, 0.1}, [](double, double, double r, double) { return -400.0 * std::tanh(r / 0.1); });
  expect("cubic_stiffness", {800.0}, [](double, double a, double, double) { return -800.0 * a * a * a; });
  expect("gravity_load", {500.0}, [](double, double a, double, double) { return -500.0 * std::sin(a); });
  expect("periodic_disturbance", {400.0, 3.0},
         [](double t, double, double, double) { return 400.0 * std::sin(2.0 * std::numbers::pi * 3.0 * t); });
  expect("quadratic_drag", {60.0}, [](double, double, double r, double) { return -60.0 * r * std::abs(r); });
  expect("obstacle", {4000.0, 0.8}, [](double, double a, double, double) { return -4000.0 * std::max(a - 0.8, 0.0); });
  double z = 0.0;
  expect("hysteresis", {400.0, 0.1}, [&z](double, double, double r, double) {
    const double travel = r * 1e-3;
    z += travel * (1.0 - (z * travel > 0.0 ? std::abs(z) / 0.1 : 0.0));
    return -400.0 * z / 0.1;
  });
  expect("payload_step", {1.0, 2.0},
         [](double t, double, double, double base) { return t >= 2.0 ? -0.5 * base : 0.0; });
}

TEST(ActuatorEffects, SensorEffectsLeaveThePlantAlone) {
  const std::vector<PlantSample> base = WithEffect("", {});
  const std::vector<PlantSample> pressure = WithEffect("pressure_bias", {700.0});
  const std::vector<PlantSample> angle = WithEffect("angle_bias", {-0.02}), late = WithEffect("sensor_delay", {0.01});
  for (std::size_t i = 20; i < base.size(); ++i) {
    ASSERT_EQ(pressure[i].inputs[2], base[i].inputs[2] + 700.0);
    ASSERT_EQ(pressure[i].output, base[i].output);
    ASSERT_EQ(angle[i].output, base[i].output - 0.02);
    ASSERT_EQ(angle[i].inputs, base[i].inputs);
    ASSERT_NEAR(late[i].output, base[i - 10].output, 1e-3);
  }
}

TEST(ActuatorEffects, AGateKeepsThemOutOfTheEquations) {
  const std::vector<PlantSample> base = WithEffect("", {}),
                                 gated = WithEffect("gravity_load", {500.0}, Gate::Parse("from:2"));
  for (std::size_t i = 0; i <= 2000; ++i) ASSERT_EQ(gated[i].output, base[i].output);
  EXPECT_GT(std::abs(gated[2500].output - base[2500].output), 0.01);
}

TEST(ActuatorEffects, TheStrengthGivesTheGapRatioOfEveryEffect) {
  Scenario scenario = BuiltinScenario("soft_actuator_excited");
  scenario.duration_s = 2.0;
  scenario.options.Set("max_step_s", 2.5e-4);  // what the meter takes itself; many searches take seconds
  const std::unique_ptr<GapMeter> meter = MakeGapMeter(scenario);
  EXPECT_LT(meter->GapRatio({}), 0.01);
  for (const EffectSpec& spec : EffectRegistry(*scenario.family)) {
    EffectRequest request;
    request.name = spec.name;
    const std::vector<HiddenEffect> effects = DecideEffects(scenario, {request}, 3);
    EXPECT_NEAR(meter->GapRatio(effects), 1.0, 0.05) << spec.name;
  }
}

}  // namespace
}  // namespace armcmc::plant_sim::actuator_effects_test
