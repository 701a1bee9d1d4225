// Whether parameters stay over a recording.
#include "armcmc/ladder/drift.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tools/ladder/made_data.hpp"

namespace armcmc::test::drift_test {
namespace {

/// Drift of an axis on whose force `hidden` acts, fitted as it is.
std::vector<gap::ParameterDrift> Drift(const std::function<double(const AxisSample&)>& hidden, unsigned seed = 3) {
  ladder::Dataset data = AxisData(hidden, seed);
  const auto plant = std::make_shared<const Plant>(AxisPlant());
  const ladder::Trial trial = ladder::FitAlone(plant, &data);
  const std::size_t own = plant->description().parameters.size();
  const ladder::TunedPlant tuned = ladder::Tuned(plant->description(), own, trial, data.training);
  return ladder::DriftOver(data, tuned, trial, nullptr, trial);
}

const gap::Constancy& Of(const std::vector<gap::ParameterDrift>& drift, const std::string& name) {
  for (const gap::ParameterDrift& one : drift)
    if (one.name == name) return one.before;
  throw std::out_of_range(name);
}

TEST(Drift, ParametersOfAPlantThatStaysAreConstant) {
  int moved = 0;
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (const gap::ParameterDrift& one : Drift([](const AxisSample&) { return 0.0; }, seed))
      moved += one.before.constant ? 0 : 1;
  // Fifteen parameters, each wrong in one of a hundred: two or more once in a hundred times.
  EXPECT_LE(moved, 1);
}

TEST(Drift, AMassThatGrowsIsSeenToMove) {
  const auto drift = Drift([](const AxisSample& s) { return s.t * s.a; });  // 100 kg to 120 kg in 20 s
  const gap::Constancy& mass = Of(drift, "M");
  EXPECT_FALSE(mass.constant);
  EXPECT_NEAR(mass.moves_by, 20.0 / std::sqrt(12.0), 1.0) << "standard deviation of an even growth";
  ASSERT_EQ(mass.course.x.size(), 10u);
  EXPECT_NEAR(mass.course.y.front(), 101.0, 2.0);
  EXPECT_NEAR(mass.course.y.back(), 119.0, 2.0);
  for (std::size_t k = 0; k < 10; ++k) {
    EXPECT_LT(mass.course.low[k], mass.course.y[k]);
    EXPECT_NEAR(mass.course.x[k], 1.0 + 2.0 * static_cast<double>(k), 0.01);
  }
  EXPECT_TRUE(Of(drift, "Fv").constant);
}

TEST(Drift, MovementIsWhatTheBandsDoNotExplain) {
  gap::Constancy steady, moving;
  ladder::JudgeConstancy({1.0, 1.1, 0.9, 1.0}, {0.1, 0.1, 0.1, 0.1}, &steady);
  EXPECT_TRUE(steady.constant);
  EXPECT_EQ(steady.moves_by, 0.0);
  EXPECT_NEAR(steady.mean, 1.0, 1e-12);
  ladder::JudgeConstancy({1.0, 2.0, 1.0, 2.0}, {0.1, 0.1, 0.1, 0.1}, &moving);
  EXPECT_FALSE(moving.constant);
  // Chi-square 100 on 3 degrees of freedom: sqrt((100 / 3 - 1) 0.01).
  EXPECT_NEAR(moving.moves_by, 0.5686, 1e-3);
  EXPECT_LT(moving.p_value, 1e-15);
}

}  // namespace
}  // namespace armcmc::test::drift_test
