#include <gtest/gtest.h>

#include <cmath>

#include "core/estimator_rig.hpp"
#include "core/plant/described_packs.hpp"
#include "core/plant/plants.hpp"

namespace armcmc::output_trajectory_test {
namespace {

using Sample = test::PlantSample;
using Noise = test::GaussianNoise;
using test::DescribedPack;

/// Fills at 2 m/s, drains at 3, is shut in between; a half wave a second. The level is a sum over the samples.
class Vessel {
 public:
  Sample operator()(double t) {
    const double phase = t - std::floor(t);
    Sample s;
    s.u[0] = phase < 0.4 ? 1.0 : phase < 0.5 ? 0.0 : phase < 0.8 ? -0.8 : 0.0;
    const double rate = s.u[0] * (s.u[0] > 0.0 ? 2.0 : 3.0);
    level_ += 0.5e-3 * (rate + before_);
    before_ = rate;
    s.u[1] = rate + noise_();
    s.y = level_;
    return s;
  }

 private:
  Noise noise_{0.05};
  double level_ = 0.0, before_ = 0.0;
};

TEST(OutputTrajectory, IsWhatThePlantFilePredictsBesideTheLaws) {
  const auto plant = test::Program(test::DescribedVessel());
  EXPECT_EQ(plant->info().num_modes, 2) << "laws that need no state are sampled apart";
  EXPECT_EQ(plant->states().size(), 0);
  ASSERT_NE(plant->prediction(), nullptr);
  EXPECT_EQ(plant->prediction()->sampled().size(), 2U) << "of all modes together";
  test::Rig rig(DescribedSettings(plant));
  Vessel vessel;
  for (std::int64_t seq = 1; seq <= 40; ++seq) {
    DataPack pack = DescribedPack(*plant, seq, [&](double t) { return vessel(t); });
    const double level = pack.y[99];
    // From here on the sensor is blind: the prediction is of the inputs alone.
    if (seq > 20) pack.y.fill(77.0);
    const Estimate& e = rig.Step(pack);
    if (seq <= 2) {
      EXPECT_TRUE(std::isnan(e.y_pred)) << "nothing is on display yet";
      continue;
    }
    // It began when filling was known and draining was not, at what the sensor said.
    if (seq < 20) continue;
    EXPECT_NEAR(e.y_shown[99], level, 0.1) << seq;
    EXPECT_EQ(e.y_free_run, e.y_shown[99]);
    EXPECT_NEAR(e.y_pred, e.y_shown[99], 0.05) << seq;
    if (seq % 10 != 3) continue;
    // The valve has been open for all of the pack: the level is as uncertain as 0.1 s of its rate.
    const double width = 2.0 * 1.96 * 0.1 * e.modes[0].marginal[0].sd;
    EXPECT_GT(e.y_hi - e.y_lo, 0.4 * width) << seq;
    EXPECT_LT(e.y_hi - e.y_lo, 2.0 * width) << seq;
  }
  EXPECT_NEAR(rig.estimate().modes[0].marginal[0].ar_ap, 2.0, 0.02);
  EXPECT_NEAR(rig.estimate().modes[1].marginal[0].ar_ap, 3.0, 0.03);
  // A pack is lost: what is shown begins anew at what the sensor says.
  const Estimate& e = rig.Step(DescribedPack(*plant, 42, [](double) {
    Sample s;
    s.y = 5.0;
    return s;
  }));
  for (std::size_t n = 0; n < 100; ++n) EXPECT_NEAR(e.y_shown[n], 5.0, 1e-12) << "nothing flows";
  EXPECT_NEAR(e.y_pred, 5.0, 1e-12) << "in a passive mode, too";
}

TEST(OutputTrajectory, LawsThatNeedAStateAreSampledWithIt) {
  PlantDescription description = test::DescribedVessel();
  description.modes[0].law = "g*u*(level/level)";
  const auto plant = test::Program(description);
  EXPECT_EQ(plant->info().num_modes, 1) << "states go on from mode to mode";
  EXPECT_EQ(plant->states().size(), 1);
  EXPECT_EQ(plant->InPrediction(0, 0), 0);
  EXPECT_EQ(plant->InPrediction(0, 1), 1);
}

TEST(OutputTrajectory, APredictionOfTooManyParametersIsAnError) {
  PlantDescription description = test::DescribedVessel();
  description.predicts = "level";
  description.modes.insert(description.modes.begin() + 1, {"half", "u > 0.5", "(a + b)*u + c*u^2", "r", false});
  for (const char* name : {"a", "b", "c"}) {
    description.parameters.push_back({name, "m/s", "normal", 0.0, 5.0});
    description.parameters.back().per_mode = true;
  }
  for (std::size_t m : {0U, 2U}) description.modes[m].law = "(g + a + b)*u + c*u^2";
  try {
    (void)test::Program(description);
    FAIL();
  } catch (const PlantError& error) {
    EXPECT_EQ(error.key(), "predicts");
  }
}

TEST(OutputTrajectory, OneThatDivergesIsUnknownAndBeginsAnew) {
  PlantDescription description = test::DescribedVessel();
  description.constants = {{"c", 1e300, "1/s"}, {"brink", 50.0, "m"}};
  description.states[0].rate = "if(u != 0, g*u, 0) + if(level > brink, c*level, 0)";
  const auto plant = test::Program(description);
  test::Rig rig(DescribedSettings(plant));
  const auto step = [&](std::int64_t seq, double level) -> const Estimate& {
    return rig.Step(DescribedPack(*plant, seq, [level](double) {
      Sample s;
      s.u = {1.0, 2.0};
      s.y = level;
      return s;
    }));
  };
  for (std::int64_t seq = 1; seq <= 4; ++seq) (void)step(seq, 1.0);
  ASSERT_NEAR(rig.estimate().y_shown[0], 1.2, 0.3);
  (void)step(6, 60.0);  // begins anew, where the rate has no bound
  EXPECT_TRUE(std::isnan(rig.estimate().y_shown[99]));
  EXPECT_TRUE(std::isnan(rig.estimate().y_pred));
  EXPECT_TRUE(std::isnan(rig.estimate().y_hi));
  (void)step(7, 1.0);
  EXPECT_NEAR(rig.estimate().y_shown[0], 1.0, 1e-9) << "at what the sensor says";
}

}  // namespace
}  // namespace armcmc::output_trajectory_test
