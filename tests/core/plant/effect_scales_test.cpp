#include "armcmc/plant/effect_scales.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "armcmc/expression/error.hpp"
#include "armcmc/plant/error.hpp"
#include "core/plant/plants.hpp"

namespace armcmc::effect_scales_test {
namespace {

TEST(EffectScales, AreThoseOfTheData) {
  const PlantDescription plant = test::SimulatedSpring();
  std::vector<double> times, drive, position;
  for (int n = 0; n < 400; ++n) {
    times.push_back(5.0 + 0.01 * n);
    drive.push_back(3.0);
    position.push_back(n % 100 < 50 ? 1.0 : -1.0);
  }
  const DataScales scales = MeasuredScales(plant, {drive, position}, times);
  EXPECT_NEAR(scales.dt, 0.01, 1e-12);
  EXPECT_EQ(scales.start, 5.0);
  EXPECT_NEAR(scales.record, 3.99, 1e-12);
  EXPECT_NEAR(scales.period, 2.0 * 3.99 / 7.0, 1e-12) << "seven crossings";
  EXPECT_NEAR(scales.quantity.at("y").rms, 1.0, 1e-12);
  EXPECT_NEAR(scales.quantity.at("u").rms, 3.0, 1e-12) << "what stands still has the size of its value";
  EXPECT_EQ(scales.quantity.at("pos").rms, scales.quantity.at("y").rms) << "role and unit of the output";
  EXPECT_NEAR(scales.quantity.at("speed").rms, 2.0 * 3.141592653589793 / scales.period, 1e-9) << "its rate";
  EXPECT_NEAR(ScaleValue("0.5*x + 2*dt + high_output", plant, scales, {{"x", "u"}}), 1.5 + 0.02 + 1.0, 1e-12);
}

TEST(EffectScales, OfARateWhoseTermsCancelAreThoseOfItsTerms) {
  PlantDescription plant = test::SimulatedSpring();
  const std::vector<double> times{0.0, 1.0, 2.0, 3.0, 4.0}, drive{0.0, 1.0, 0.0, -1.0, 0.0};
  const std::vector<double> position{0.0, 1.0, 0.0, -1.0, 0.0};
  const double free = ScaleValue("rate_v", plant, MeasuredScales(plant, {drive, position}, times), {{"v", "speed"}});
  plant.constants = {{"d", 1e4, "1/s"}};
  plant.states[1].rate = "u - k*pos - d*speed";
  plant.parameters[0].mean = 1e4;
  plant.parameters[0].upper = 1e6;
  const DataScales scales = MeasuredScales(plant, {drive, position}, times);
  const double damped = ScaleValue("rate_v", plant, scales, {{"v", "speed"}});
  EXPECT_LT(free, 100.0);
  EXPECT_NEAR(damped, 0.1 * 1e4 * std::max(scales.quantity.at("speed").rms, scales.quantity.at("pos").rms), 1.0);
}

TEST(EffectScales, RefuseWhatIsNoSizeAndDataThatAreNone) {
  const PlantDescription plant = test::SimulatedSpring();
  EXPECT_THROW((void)ScaleValue("0.5*w", plant, DefaultScales(plant), {}), expression::Error);
  EXPECT_THROW((void)ScaleValue("output/0", plant, DefaultScales(plant), {}), expression::Error);
  EXPECT_THROW((void)MeasuredScales(plant, {{1.0}, {1.0}}, {0.0}), PlantError);
  EXPECT_THROW((void)MeasuredScales(plant, {{1.0, 2.0}, {1.0, std::nan("")}}, {0.0, 1.0}), PlantError);
}

TEST(EffectScales, WithoutDataFollowFromNoiseAndPriors) {
  const DataScales scales = DefaultScales(test::DescribedAxis());
  EXPECT_EQ(scales.quantity.at("F").rms, 30.0);
  EXPECT_DOUBLE_EQ(scales.quantity.at("v").rms, 30.0 / 300.0) << "Fv = 200 +- 100 N s/m";
  EXPECT_DOUBLE_EQ(scales.quantity.at("a").rms, 30.0 / 120.0) << "M = 90 +- 30 kg";
}

}  // namespace
}  // namespace armcmc::effect_scales_test
