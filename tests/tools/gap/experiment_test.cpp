// The experiment that is proposed where a recording leaves two effects open.

#include "armcmc/gap/experiment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <memory>
#include <string>

#include "armcmc/gap/diagnose.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"
#include "tools/gap/gap_rig.hpp"

namespace armcmc::gap::experiment_test {
namespace {

using ::testing::HasSubstr;

constexpr double kNoise = 0.1;  // N

class SeparatingExperimentTest : public ::testing::Test {
 protected:
  SeparatingExperimentTest() {
    analysis_.signals = bench_.signals;
    analysis_.fitter = std::make_unique<Fitter>(*bench_.equation, analysis_.signals, test::White(kNoise));
    base_ = bench_.Base(*analysis_.fitter);
    analysis_.finding.best = std::make_shared<Candidate>();
    analysis_.finding.best->fit = base_;
  }
  /// The law with one effect of that size, SI.
  [[nodiscard]] CandidatePtr With(const std::string& effect, double size, When::Kind kind) const {
    auto candidate = std::make_shared<Candidate>();
    candidate->fit = analysis_.fitter->Add(base_, {&bench_.Form(effect), {kind, 0.0}});
    candidate->fit.theta[3] = size / candidate->fit.coordinates[3].unit_size;
    candidate->probability = 0.5;
    return candidate;
  }
  [[nodiscard]] Experiment Between(const CandidatePtr& a, const CandidatePtr& b) const {
    return SeparatingExperiment(*bench_.equation, analysis_, {a, b});
  }

  const test::Bench bench_{test::Measure({}, 1200, kNoise, 3, 5e-3).recording};
  Analysis analysis_;
  Fitted base_;
};

TEST_F(SeparatingExperimentTest, IsTheMotionThatShowsTheDifferenceMostOfTheTime) {
  const Experiment free =
      Between(With("force_bias", kNoise, When::Kind::kFree), With("viscous_friction", kNoise, When::Kind::kFree));
  EXPECT_EQ(free.program, "free_air_chirp");
  EXPECT_EQ(free.pace, 1.0) << "a quicker motion would bring nothing that is needed";
  EXPECT_EQ(free.sample_interval_s, 5e-3);
  // A bias as large as the noise, 1200 samples long: half a nat each. No drag imitates it in a motion to and fro.
  EXPECT_NEAR(free.nats, 600.0, 30.0);
  const Experiment contact =
      Between(With("force_bias", kNoise, When::Kind::kContact), With("viscous_friction", kNoise, When::Kind::kContact));
  EXPECT_NE(contact.program, "free_air_chirp");
  EXPECT_GT(contact.nats, 0.0);
}

TEST_F(SeparatingExperimentTest, SaysThatNoMotionWouldHelp) {
  const Experiment none =
      Between(With("force_bias", kNoise, When::Kind::kAlways), With("force_bias", kNoise, When::Kind::kAlways));
  EXPECT_NEAR(none.nats, 0.0, 1e-6);
  EXPECT_THAT(none.words, HasSubstr("so little that repeating it would hardly help"));
}

TEST_F(SeparatingExperimentTest, IsAScenarioThatThePlantRuns) {
  const Experiment experiment =
      Between(With("force_bias", kNoise, When::Kind::kFree), With("viscous_friction", kNoise, When::Kind::kFree));
  const std::string text = ScenarioText(*bench_.equation, analysis_, experiment);
  for (const char* line :
       {"sample_interval_s = 0.005\n", "pack_period_s = 0.5\n", "program = \"free_air_chirp\"\n", "std = 0.1   # N\n"})
    EXPECT_THAT(text, HasSubstr(line));
  const armcmc::test::ScratchDir dir;
  std::ofstream(dir / "separate.toml") << text;
  const armcmc::test::Outcome run = armcmc::test::RunProgram(
      armcmc::test::Program("armcmc-plant"), {"--scenario", dir / "separate.toml", "--csv", dir / "run.csv"});
  EXPECT_EQ(run.code, 0) << run.err << text;
}

}  // namespace
}  // namespace armcmc::gap::experiment_test
