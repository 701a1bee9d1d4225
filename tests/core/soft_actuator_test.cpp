#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "estimator_rig.hpp"

namespace armcmc {
namespace {

using test::Actuator;
using test::Rig;

TEST(SoftActuator, SwitchInAPackUpdatesBothModesEachFromItsOwnSamples) {
  Rig rig(test::ActuatorSettings());
  const Actuator plant;
  const Estimate& e = rig.Step(plant.Pack(1, 60));
  EXPECT_EQ(rig.status, Status::kOk);
  EXPECT_EQ(e.mode, 1) << "the mode at the last sample";
  EXPECT_EQ(e.modes[0].num_samples, 60);
  EXPECT_EQ(e.modes[1].num_samples, 40);
  for (std::size_t m = 0; m < 2; ++m) {
    EXPECT_TRUE(e.modes[m].updated);
    test::ExpectUsable(e.modes[m], rig.estimator.settings());
    const MarginalSummary& g = e.modes[m].marginal[0];
    EXPECT_NEAR(g.ar_ap, plant.gain[m], 4.0 * g.sd) << m;
    EXPECT_LT(g.sd, 1e-5) << m;
  }
}

TEST(SoftActuator, SamplesOfOneModeDoNotTouchTheOther) {
  Rig one(test::ActuatorSettings()), other(test::ActuatorSettings());
  const DataPack pack = Actuator{}.Pack(1, 60);
  DataPack changed = pack;
  for (std::size_t n = 60; n < 100; ++n) changed.u[n][1] *= 1.7;
  const ModeEstimate a = one.Step(pack).modes[0];
  const ModeEstimate b = other.Step(changed).modes[0];
  EXPECT_EQ(std::memcmp(&a.marginal, &b.marginal, sizeof a.marginal), 0);
  EXPECT_NE(one.estimate().modes[1].marginal[0].ar_ap, other.estimate().modes[1].marginal[0].ar_ap);
}

TEST(SoftActuator, ModeIsKeptWhileTheSystemIsElsewhere) {
  Rig rig(test::ActuatorSettings());
  const Actuator plant;
  for (std::int64_t seq = 1; seq <= 5; ++seq) rig.Step(plant.Pack(seq, 100));
  const ModeEstimate learnt = rig.estimate().modes[0];
  EXPECT_FALSE(rig.estimate().modes[1].known);
  for (std::int64_t seq = 6; seq <= 10; ++seq) rig.Step(plant.Pack(seq, 0));
  EXPECT_EQ(rig.estimate().modes[0].decision, Decision::kHold);
  EXPECT_EQ(std::memcmp(&rig.estimate().modes[0].marginal, &learnt.marginal, sizeof learnt.marginal), 0);
  rig.Step(plant.Pack(11, 100));
  EXPECT_EQ(rig.estimate().modes[0].decision, Decision::kReinforcement);
  EXPECT_LT(rig.estimate().modes[0].marginal[0].sd, 1.1 * learnt.marginal[0].sd);
}

TEST(SoftActuator, ReportsTheGainAndThePaperParametersConsistently) {
  Rig rig(test::ActuatorSettings());
  for (std::int64_t seq = 1; seq <= 3; ++seq) rig.Step(Actuator{}.Pack(seq, 100));
  const auto& m = rig.estimate().modes[0].marginal;
  EXPECT_NEAR(m[2].ar_ap, m[0].ar_ap - m[1].ar_ap * PlantConstants{}.p_atm, 1e-12);
  EXPECT_NEAR(m[1].ar_ap, 6.12e-9, 4.0 * m[1].sd);
  EXPECT_NEAR(m[2].ar_ap, -2.14e-4, 4.0 * m[2].sd);
}

TEST(SoftActuator, ShutValvesHoldBothModes) {
  Rig rig(test::ActuatorSettings());
  rig.Step(Actuator{}.Pack(1, 60));
  DataPack shut = Actuator{}.Pack(2, 60);
  for (auto& u : shut.u) u[0] = u[1] = 0.0;
  const Estimate& e = rig.Step(shut);
  EXPECT_EQ(rig.status, Status::kHeld);
  EXPECT_FALSE(e.active);
  EXPECT_EQ(e.mode, 2);
  EXPECT_TRUE(e.modes[0].known && e.modes[1].known);
  EXPECT_TRUE(std::isfinite(e.y_pred) && std::isfinite(e.y_free_run));
}

TEST(SoftActuator, ThetaTwoStaysWideWhenThePressureDoesNotMove) {
  EstimatorSettings settings = BuiltinSettings("soft_actuator");
  Rig rig(settings);
  const Actuator plant;
  for (std::int64_t seq = 1; seq <= 5; ++seq) {
    DataPack pack = plant.Pack(seq, 100);
    for (std::size_t n = 0; n < 100; ++n) {  // a pascal of swing, as in the paper's own data
      const double phase = 0.05 * static_cast<double>(n), over = 1.5 + 0.1 * std::sin(phase),
                   rate = 5.0 * std::cos(phase);
      pack.u[n] = {rate * (plant.gain[0] + plant.slope[0] * over) / std::sqrt(800e3 - plant.p_atm - over), 0.0,
                   plant.p_atm + over, rate};
    }
    rig.Step(pack);
  }
  const auto& m = rig.estimate().modes[0].marginal;
  EXPECT_NEAR(m[0].ar_ap / plant.gain[0], 1.0, 1e-3);
  EXPECT_GT(m[1].sd, 0.3 * settings.parameters[1].sd);
}

}  // namespace
}  // namespace armcmc
