// A plant that a file describes: the running estimator notices what its model misses and keeps the data, armcmc-gap
// names it, and the estimator goes on with the model that has it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "armcmc/estimate_t.hpp"
#include "integration/described_story.hpp"

namespace armcmc::test::gap_described_live_test {
namespace {

TEST_F(DescribedStory, HiddenFrictionIsNoticedNamedAndLearnt) {
  std::string axis = Text(SourceDir() / "core/plants/servo_axis/plant.toml");
  axis.replace(axis.find("+ off"), 5, "+ off + 12*sign(v)");
  std::ofstream(dir_ / "plant.toml") << axis;
  std::ofstream(dir_ / "scenario.toml")
      << "schema = 1\nrate_hz = 500\nduration_s = 24\n[truth]\nM = 95.0\nFv = 210.0\noff = -3.0\n"
         "[inputs]\nq = { expression = \"0.08*sin(2.3*t) + 0.03*sin(7.1*t)\" }\n[noise]\nlaw = \"gaussian\"\nstd = "
         "4.0\n";
  const Outcome made =
      RunProgram(Program("armcmc-plant"), {"--model", dir_ / "plant.toml", "--scenario", dir_ / "scenario.toml",
                                           "--csv", dir_ / "run.csv", "--log", dir_ / "run.log"});
  ASSERT_EQ(made.code, 0) << made.err;

  const Json gap = Watched(dir_ / "run.log", 240);
  ASSERT_EQ(gap["suspected"], true) << gap.dump();
  EXPECT_EQ(gap["where"], "direction_of_v");
  EXPECT_THAT(said_, ::testing::HasSubstr("seen in direction_of_v"));
  const Json result = Diagnosed(gap);
  EXPECT_EQ(result["verdict"], "named");
  ASSERT_FALSE(result["ladder"].empty());
  EXPECT_EQ(result["ladder"][0]["effects"][0], "coulomb_friction");
  EXPECT_EQ(result["complete"], true);

  auto estimator = StartEstimator({"--model", dir_ / "gap/model.toml"});
  ASSERT_EQ(PlayLog(dir_ / "run.log"), 240u) << estimator->err();
  const Json report = Finish(estimator.get());
  EXPECT_EQ(report["gap"]["watched"], true);
  EXPECT_EQ(report["gap"]["suspected"], false) << report["gap"].dump();
  const estimate_t last = recorder_->estimates().back();
  int friction = 0;
  while (friction < last.n_params &&
         std::string(reinterpret_cast<const char*>(last.param_name[friction])).find("coulomb") != 0)
    ++friction;
  ASSERT_LT(friction, last.n_params) << "no parameter of the friction";
  EXPECT_NEAR(last.ar_map[friction], 12.0, 5.0 * last.sd[friction]);
  EXPECT_LT(last.sd[friction], 1.2);
}

}  // namespace
}  // namespace armcmc::test::gap_described_live_test
