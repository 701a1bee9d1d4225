// The catalogue of effects as a user of armcmc-model meets it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <regex>
#include <string>

#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::model::effect_program_test {
namespace {

using testing::HasSubstr;

class EffectProgram : public ::testing::Test {
 protected:
  test::Outcome Run(const std::vector<std::string>& arguments) const {
    return test::RunProgram(test::Program("armcmc-model"), arguments, std::chrono::minutes(1), dir_.path());
  }
  test::ScratchDir dir_;
};

TEST_F(EffectProgram, ListsEffectsWithWhatTheyNeed) {
  const test::Outcome list = Run({"list"});
  EXPECT_EQ(list.code, 0) << list.err;
  EXPECT_TRUE(std::regex_search(
      list.out, std::regex("coulomb_friction +dry friction +velocity, output force; or velocity state +Dry")));
  EXPECT_TRUE(std::regex_search(list.out, std::regex("sensor_delay +latency +nothing ")));
}

TEST_F(EffectProgram, ShowsTheComposedLawAndWhatElseFits) {
  const test::Outcome check = Run({"check", "servo_axis", "--with", "coulomb_friction,backlash"});
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("coulomb_friction_Fc*sign(v)"));
  EXPECT_THAT(check.out, HasSubstr("backlash_z"));
  const test::Outcome fitting = Run({"check", "two_tanks", "--effects"});
  EXPECT_TRUE(std::regex_search(fitting.out, std::regex("linear_loss +high; or low ")));
  EXPECT_TRUE(std::regex_search(fitting.out, std::regex("adhesion +- +- +its output would be a force")));
}

TEST_F(EffectProgram, ShowsWhatTheEstimatorDoesNotRun) {
  const test::Outcome runs = Run({"check", "servo_axis", "--with", "sensor_delay"});
  EXPECT_EQ(runs.code, 0) << runs.err;
  EXPECT_THAT(runs.out, HasSubstr("delay(M*a + Fv*v + off, sensor_delay_tau)"));
  EXPECT_THAT(runs.out, HasSubstr("the estimator samples M, Fv, off, sensor_delay_tau"));
  const test::Outcome state = Run({"check", "oscillator", "--with", "sensor_delay"});
  EXPECT_EQ(state.code, 0) << state.err;
  EXPECT_THAT(state.out, HasSubstr("the estimator samples m, d, k, sensor_delay_tau"));
  // More parameters than it samples.
  const test::Outcome check =
      Run({"check", "oscillator", "--with", "cogging,periodic_disturbance,backlash,hysteresis"});
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("the estimator does not run it: "));
}

TEST_F(EffectProgram, WritesThePlantWithTheEffectSizedByData) {
  std::ofstream csv(dir_ / "run.csv");
  csv << "t,q,F\n";
  for (int n = 0; n < 500; ++n)
    csv << 0.01 * n << ',' << 0.1 * std::sin(0.06 * n) << ',' << 80.0 * std::sin(0.06 * n) << '\n';
  csv.close();
  const test::Outcome add = Run({"add", "servo_axis", "coulomb_friction", "--data", "run.csv", "--out", "with.toml"});
  ASSERT_EQ(add.code, 0) << add.err;
  EXPECT_THAT(add.out, HasSubstr("parameters added: coulomb_friction_Fc"));
  const test::Outcome check = Run({"check", "with.toml"});
  EXPECT_EQ(check.code, 0) << check.err;
  // Half of 80 / sqrt(2); the record is no whole number of periods.
  std::smatch sd;
  ASSERT_TRUE(std::regex_search(check.out, sd, std::regex("coulomb_friction_Fc +N +0 \\+- ([0-9.]+)"))) << check.out;
  EXPECT_NEAR(std::stod(sd[1]), 40.0 / std::sqrt(2.0), 1.0);
  const test::Outcome again = Run({"add", "servo_axis", "coulomb_friction", "--out", "with.toml"});
  EXPECT_EQ(again.code, 2);
  EXPECT_THAT(again.err, HasSubstr("already exists"));
}

TEST_F(EffectProgram, EndsWithOneLineWhereTheEffectIsNoneOrDoesNotFit) {
  const test::Outcome none = Run({"check", "servo_axis", "--with", "coulomb_fricton"});
  EXPECT_EQ(none.code, 2);
  EXPECT_THAT(none.err, HasSubstr("did you mean coulomb_friction?"));
  const test::Outcome unfit = Run({"add", "servo_axis", "overflow", "--out", "x.toml"});
  EXPECT_EQ(unfit.code, 2);
  EXPECT_THAT(unfit.err, HasSubstr("overflow does not fit servo_axis"));
}

}  // namespace
}  // namespace armcmc::model::effect_program_test
