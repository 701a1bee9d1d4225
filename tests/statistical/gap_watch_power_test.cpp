#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "armcmc/adjust_result.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/plant_sim/effects/hide.hpp"
#include "armcmc/plant_sim/pack_builder.hpp"
#include "builtin_scenario.hpp"

namespace armcmc::gap_watch_power_test {
namespace {

/// State of the watch after `seconds` of a scenario, through the whole estimator.
GapState Watch(const plant_sim::Scenario& scenario, std::uint64_t seed, double seconds, const std::string& model) {
  EstimatorSettings settings = BuiltinSettings(model);
  // The watch needs to know only about where the parameters are.
  settings.sampler.rule = DrawRule::kFixed;
  settings.sampler.fixed_draws = settings.sampler.max_draws = 1000;
  Estimator estimator(settings);
  const auto result = estimator.MakeResult();
  const auto estimate = std::make_unique<Estimate>();
  const auto pack = std::make_unique<DataPack>();
  plant_sim::PackBuilder builder(scenario, seed, 1);
  const auto packs = static_cast<std::int64_t>(seconds / scenario.pack_period_s());
  for (std::int64_t k = 1; k <= packs; ++k) {
    EXPECT_TRUE(builder.Next());
    const data_pack_t& sent = builder.pack();
    pack->seq = sent.seq;
    pack->run_id = sent.run_id;
    pack->dt = sent.dt;
    pack->t_last_s = sent.t_last_s;
    pack->plant = static_cast<PlantNumber>(sent.plant_kind);
    pack->num_samples = sent.n_samples;
    pack->num_inputs = sent.n_inputs;
    std::copy_n(sent.y, sent.n_samples, pack->y.begin());
    for (std::size_t n = 0; n < static_cast<std::size_t>(sent.n_samples); ++n)
      std::copy_n(sent.u[n], sent.n_inputs, pack->u[n].begin());
    (void)estimator.Adjust(*pack, 0, ClockRef{}, result.get());
    estimator.Execute(*result, estimate.get());
  }
  return estimate->gap;
}

plant_sim::Scenario Scenario(const std::string& name, double seconds) {
  plant_sim::Scenario scenario = plant_sim::BuiltinScenario(name);
  scenario.duration_s = seconds;
  return scenario;
}

plant_sim::Scenario Hiding(const std::string& scenario_name, const std::string& effect, double gap_ratio,
                           std::uint64_t seed, double seconds) {
  plant_sim::Scenario scenario = Scenario(scenario_name, seconds);
  scenario.hidden =
      plant_sim::DecideEffects(scenario, plant_sim::ParseEffectRequests(effect, plant_sim::Gate{}, gap_ratio), seed);
  return scenario;
}

TEST(GapWatchPower, FindsEffectsOfHalfTheNoiseWithinAMinute) {
  // The strength is that of an effect whose remainder, after the best parameters, is half the noise. Two kinds are left
  // out: stiffness_drift, which the watch takes for the drift of a parameter that it is, and sensor_saturation, which
  // needs about twice the strength.
  constexpr double kSeconds = 60.0;
  for (const char* effect :
       {"force_bias", "force_drift", "coulomb_friction", "presliding_friction", "viscous_friction", "inertia",
        "sensor_delay", "sensor_lag", "stress_relaxation", "contact_offset", "adhesion", "periodic_disturbance"}) {
    const GapState state = Watch(Hiding("hunt_crossley_paper", effect, 0.5, 1, kSeconds), 1, kSeconds, "hunt_crossley");
    EXPECT_TRUE(state.suspected) << effect << ": log evidence " << state.log_evidence;
  }
}

TEST(GapWatchPower, FindsWhatTheValvesOfTheActuatorHide) {
  constexpr double kSeconds = 40.0;
  for (const char* effect : {"leak", "valve_dead_band", "valve_lag", "supply_droop"}) {
    const GapState state =
        Watch(Hiding("soft_actuator_excited", effect, 1.0, 1, kSeconds), 1, kSeconds, "soft_actuator_excited");
    EXPECT_TRUE(state.suspected) << effect << ": log evidence " << state.log_evidence;
  }
}

TEST(GapWatchPower, FindsWhatBendsTheActuator) {
  constexpr double kSeconds = 40.0;
  for (const char* effect : {"joint_friction", "cubic_stiffness", "gravity_load", "hysteresis", "payload_step",
                             "periodic_disturbance", "pressure_bias", "angle_bias", "sensor_delay"}) {
    const GapState state =
        Watch(Hiding("soft_actuator_excited", effect, 1.0, 1, kSeconds), 1, kSeconds, "soft_actuator_excited");
    EXPECT_TRUE(state.suspected) << effect << ": log evidence " << state.log_evidence;
    EXPECT_NE(state.where.view().find("bend"), std::string_view::npos) << effect << ": " << state.where.view();
  }
}

TEST(GapWatchPower, IsSilentWithoutAHiddenEffect) {
  constexpr double kSeconds = 120.0;
  for (const char* name : {"hunt_crossley_paper", "hunt_crossley_drift", "hunt_crossley_step", "hunt_crossley_chatter",
                           "hunt_crossley_heavy_tailed", "hunt_crossley_impulsive"})
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const GapState state = Watch(Scenario(name, kSeconds), seed, kSeconds, "hunt_crossley");
      EXPECT_FALSE(state.suspected) << name << ' ' << seed << ": " << state.where.view();
      EXPECT_GE(state.num_blocks, 9);
    }
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const GapState state = Watch(Scenario("soft_actuator_excited", kSeconds), seed, kSeconds, "soft_actuator_excited");
    EXPECT_FALSE(state.suspected) << seed << ": " << state.where.view();
  }
  const GapState quiet = Watch(Scenario("soft_actuator_paper", kSeconds), 1, kSeconds, "soft_actuator");
  EXPECT_FALSE(quiet.suspected) << quiet.where.view();
}

}  // namespace
}  // namespace armcmc::gap_watch_power_test
