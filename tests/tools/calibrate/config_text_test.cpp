#include "armcmc/calibrate/config_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "armcmc/support/estimator_config.hpp"
#include "support/paths.hpp"
#include "tools/file_text.hpp"

namespace armcmc::calibrate::config_text_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string Shipped(const std::string& name) { return test::TextOf(test::SourceDir() / "rt/config" / name); }

EstimatorSettings Read(const std::string& text) {
  auto root = support::StrictTable::FromText(text, "calibrated.toml");
  const EstimatorSettings settings = support::ReadEstimatorSettings(root, "");
  for (const char* key : {"timing", "rt", "lcm", "gap_log"}) root.LeaveToOthers(key);
  root.Finish();
  return settings;
}

TEST(CalibratedConfig, ReplacesNoiseAndThresholdAndKeepsTheRest) {
  EstimatorSettings wanted = BuiltinSettings("hunt_crossley");
  wanted.noise[0].kind = NoiseKind::kMixture;
  wanted.noise[0].std = 0.0123456789012345;
  wanted.noise[0].outlier_weight = 0.07;
  wanted.noise[0].outlier_scale = 8.5;
  wanted.forgetting.threshold = 0.375;
  wanted.forgetting.rho = 0.01;
  const std::string text = CalibratedConfig(Shipped("hunt_crossley.toml"), wanted, {"contact"});
  const EstimatorSettings read = Read(text);
  EXPECT_EQ(read.noise[0].kind, NoiseKind::kMixture);
  EXPECT_EQ(read.noise[0].std, wanted.noise[0].std);
  EXPECT_EQ(read.noise[0].outlier_weight, 0.07);
  EXPECT_EQ(read.noise[0].outlier_scale, 8.5);
  EXPECT_EQ(read.forgetting.threshold, 0.375);
  EXPECT_EQ(read.forgetting.rho, 0.01);
  EXPECT_THAT(text, HasSubstr("sd = 2.0"));
  EXPECT_THAT(text, HasSubstr("url = \"udpm://239.255.76.67:7667?ttl=0\"   # ttl=1 reaches a second computer"));
  EXPECT_THAT(text, Not(HasSubstr("std = 0.1 ")));
  // Once more is the same: nothing piles up.
  EXPECT_EQ(Read(CalibratedConfig(text, wanted, {"contact"})).noise[0].std, wanted.noise[0].std);
}

TEST(CalibratedConfig, EveryModeHasItsNoise) {
  EstimatorSettings wanted = BuiltinSettings("soft_actuator");
  wanted.noise[0].std = 2e-6;
  wanted.noise[1].std = 3e-6;
  wanted.noise[1].kind = NoiseKind::kStudentT;
  wanted.noise[1].dof = 5.5;
  const EstimatorSettings read = Read(CalibratedConfig(Shipped("soft_actuator.toml"), wanted, {"u_c", "u_d"}));
  EXPECT_EQ(read.noise[0].std, 2e-6);
  EXPECT_EQ(read.noise[1].std, 3e-6);
  EXPECT_EQ(read.noise[1].kind, NoiseKind::kStudentT);
  EXPECT_EQ(read.noise[1].dof, 5.5);
}

TEST(CalibratedConfig, TablesThatAreMissingAreMade) {
  EstimatorSettings wanted = BuiltinSettings("hunt_crossley");
  wanted.forgetting.threshold = 0.5;
  const EstimatorSettings read =
      Read(CalibratedConfig("schema = 1\n[model]\nname = \"hunt_crossley\"\n", wanted, {"contact"}));
  EXPECT_EQ(read.forgetting.threshold, 0.5);
}

}  // namespace
}  // namespace armcmc::calibrate::config_text_test
