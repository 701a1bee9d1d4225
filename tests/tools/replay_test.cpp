#include "armcmc/replay/replay.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "armcmc/replay/estimate_csv.hpp"
#include "support/paths.hpp"
#include "tools/replay_data.hpp"

namespace armcmc::replay::replay_test {
namespace {

EstimatorSettings Settings() {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  settings.sampler.rule = DrawRule::kFixed;
  settings.sampler.fixed_draws = 3000;
  return settings;
}

class ReplayTest : public ::testing::Test {
 protected:
  ReplayTest() {
    std::ofstream(dir_ / "contact.csv") << ContactCsv(1001);
    request_.data = dir_ / "contact.csv";
  }
  /// The estimate CSV of one replay.
  std::string Run(const EstimatorSettings& settings) {
    Estimator estimator(settings);
    const auto source = OpenSource(request_);
    std::ostringstream out;
    EstimateCsv csv(estimator, &out);
    summary_ = Replay(source.get(), &estimator, [&](const RecordedPack&, const Estimate& e) { csv.Write(e); });
    return out.str();
  }
  test::ScratchDir dir_;
  SourceRequest request_ = ContactRequest();
  ReplaySummary summary_;
};

TEST_F(ReplayTest, LearnsTheContact) {
  Run(Settings());
  EXPECT_EQ(summary_.packs, 10);
  EXPECT_NEAR(summary_.data_s, 1.0, 1e-12);
  EXPECT_GE(summary_.modifications, 1) << "the first pack always is one";
  const auto& marginal = summary_.last.modes[0].marginal;
  EXPECT_NEAR(marginal[0].ar_ap, 4.0, 0.5);
  EXPECT_NEAR(marginal[1].ar_ap, 2.3, 0.5);
  EXPECT_NEAR(marginal[2].ar_ap, 1.7, 0.1);
}

TEST_F(ReplayTest, IsTheSameEveryTimeAndAnotherWithAnotherSeed) {
  const std::string first = Run(Settings());
  EXPECT_EQ(Run(Settings()), first);
  EstimatorSettings other = Settings();
  other.sampler.seed = 99;
  EXPECT_NE(Run(other), first);
}

TEST_F(ReplayTest, ACutRunIsRepeatedFromItsOwnOutput) {
  std::ofstream(dir_ / "limits.csv") << "pack,draws\n1,0\n2,700\n3,0\n4,1500\n5,0\n6,0\n7,0\n8,0\n9,0\n10,0\n";
  request_.draws_from = dir_ / "limits.csv";
  const std::string cut = Run(Settings());
  EXPECT_EQ(summary_.truncated, 2);
  std::ofstream(dir_ / "cut.csv") << cut;
  request_.draws_from = dir_ / "cut.csv";
  EXPECT_EQ(Run(Settings()), cut);
  request_.draws_from.clear();
  EXPECT_NE(Run(Settings()), cut) << "the cut must make a difference, or this test sees nothing";
}

}  // namespace
}  // namespace armcmc::replay::replay_test
