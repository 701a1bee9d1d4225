#include "armcmc/replay/verify.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/replay/replay.hpp"
#include "armcmc/rt/messages.hpp"
#include "armcmc/support/program.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"
#include "tools/file_text.hpp"
#include "tools/replay_data.hpp"

namespace armcmc::replay::verify_test {
namespace {

using ::testing::HasSubstr;

constexpr int kPacks = 8;

/// A log as a live run leaves it: packs, estimates and posteriors, the latter computed by an estimator.
class VerifyTest : public ::testing::Test {
 protected:
  VerifyTest() {
    settings_.sampler.rule = DrawRule::kFixed;
    settings_.sampler.fixed_draws = 600;
    std::ofstream(dir_ / "own.toml") << "schema = 1\n[model]\nname = \"hunt_crossley\"\n[sampler]\ndraws = 600\n";
  }
  using Change = std::function<void(std::int64_t seq, estimate_t*, posterior_t*)>;
  void Record(
      const Change& change = [](std::int64_t, estimate_t*, posterior_t*) {}, std::int64_t lose_pack = 0) {
    LogWriter packs_only(dir_ / "packs.lcm"), log(dir_ / "run.lcm");
    for (int k = 1; k <= kPacks; ++k) packs_only.Write("PLANT_PACK", ContactPack(k));
    packs_only.Flush();
    rt::EstimatorEngine names(settings_);
    Estimator estimator(settings_);
    const auto source = OpenSource(Request("packs.lcm"));
    Replay(source.get(), &estimator, [&](const RecordedPack&, const Estimate& e) {
      rt::StepOutput output;
      output.estimate = e;
      output.info.seq = e.seq;
      output.info.run_id = e.run_id;
      estimate_t estimate{};
      posterior_t posterior{};
      rt::FillEstimate(output, names, 1'000 + e.seq, &estimate);
      rt::FillPosterior(output, names, 2'000 + e.seq, &posterior);
      estimate.t_release_ns = 5, estimate.t_done_ns = 7;
      change(e.seq, &estimate, &posterior);
      change_t belief{};
      rt::FillChange(output, names, 3'000 + e.seq, &belief);
      if (e.seq == wrong_belief_) belief.p_drifted[0] += 1e-15;
      if (e.seq != lose_pack) log.Write("PLANT_PACK", ContactPack(e.seq));
      log.Write("EST_ESTIMATE", estimate);
      log.Write("EST_POSTERIOR", posterior);
      if (with_change_) log.Write("EST_CHANGE", belief);
    });
    log.Flush();
  }
  SourceRequest Request(const std::string& name) {
    SourceRequest request = ContactRequest();
    request.data = dir_ / name;
    return request;
  }
  Verification Verify() {
    Verifier verifier(dir_ / "run.lcm", "", settings_);
    Estimator estimator(settings_);
    const auto source = OpenSource(Request("run.lcm"));
    Replay(source.get(), &estimator, [&](const RecordedPack&, const Estimate& e) { verifier.Check(e); });
    return verifier.Finish();
  }
  test::Outcome Program(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"--data", dir_ / "run.lcm", "--config", dir_ / "own.toml", "--verify"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return test::RunProgram(test::Program("armcmc-replay"), arguments);
  }

  test::ScratchDir dir_;
  EstimatorSettings settings_ = BuiltinSettings("hunt_crossley");
  bool with_change_ = false;  ///< Older logs have no such channel.
  std::int64_t wrong_belief_ = 0;
};

TEST_F(VerifyTest, ARunIsEqualToItself) {
  Record();
  const Verification v = Verify();
  EXPECT_TRUE(v.equal()) << v.first_difference;
  EXPECT_EQ(v.compared, 2 * kPacks);
  EXPECT_EQ(v.without_pack, 0);
  const test::Outcome o = Program();
  EXPECT_EQ(o.code, 0) << o.out << o.err;
  EXPECT_THAT(o.out, HasSubstr("verified: 16 recorded messages are bit-identical"));
}

TEST_F(VerifyTest, WhatIsBelievedAboutChangeIsComparedWhereItWasPublished) {
  with_change_ = true;
  Record();
  const Verification v = Verify();
  EXPECT_TRUE(v.equal()) << v.first_difference;
  EXPECT_EQ(v.compared, 3 * kPacks);
  wrong_belief_ = 6;
  Record();
  EXPECT_EQ(Verify().different, 1);
  EXPECT_THAT(Verify().first_difference, HasSubstr("pack 6 (t = 0.6 s), EST_CHANGE: p_drifted[0] is "));
}

TEST_F(VerifyTest, OneBitIsSeenAndNamed) {
  Record([](std::int64_t seq, estimate_t* e, posterior_t*) {
    if (seq == 5) e->ar_map[2] = std::nextafter(e->ar_map[2], 10.0);
  });
  const Verification v = Verify();
  EXPECT_FALSE(v.equal());
  EXPECT_EQ(v.different, 1);
  EXPECT_THAT(v.first_difference, HasSubstr("pack 5 (t = 0.5 s), EST_ESTIMATE: ar_map[2] is "));
  const test::Outcome o = Program();
  EXPECT_EQ(o.code, 1);
  EXPECT_THAT(o.out, HasSubstr("NOT EQUAL: 1 of 16 recorded messages differ; first, pack 5"));
}

TEST_F(VerifyTest, ABinOfAPosteriorIsSeenAndNamed) {
  Record([](std::int64_t seq, estimate_t*, posterior_t* p) {
    if (seq >= 3) p->density[1][17] += 1e-12;
  });
  const Verification v = Verify();
  EXPECT_EQ(v.different, kPacks - 2);
  EXPECT_THAT(v.first_difference, HasSubstr("pack 3 (t = 0.3 s), EST_POSTERIOR: density[1][17] is "));
}

TEST_F(VerifyTest, AnotherSeedIsAnotherRun) {
  Record();
  const test::Outcome o = Program({"--seed", "99", "--report", dir_ / "r.json"});
  EXPECT_EQ(o.code, 1);
  EXPECT_THAT(o.out, HasSubstr("(--seed)"));
  EXPECT_THAT(test::TextOf(dir_ / "r.json"), HasSubstr("\"equal\": false"));
}

TEST_F(VerifyTest, ALostPackIsSaidToBeTheCause) {
  Record([](std::int64_t, estimate_t*, posterior_t*) {}, /*lose_pack=*/2);
  const Verification v = Verify();
  EXPECT_FALSE(v.equal());
  EXPECT_EQ(v.without_pack, 1);
  EXPECT_THAT(v.first_difference, HasSubstr("pack 3 "));
  EXPECT_THAT(Program().out, HasSubstr("packs are missing in the log"));
}

TEST_F(VerifyTest, WhatCannotBeVerifiedIsBadInput) {
  {
    LogWriter log(dir_ / "run.lcm");
    log.Write("PLANT_PACK", ContactPack(1));
  }
  test::Outcome o = Program();
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, HasSubstr("holds no EST_ESTIMATE to compare with"));
  std::ofstream(dir_ / "packs.csv") << ContactCsv(301);
  o = test::RunProgram(test::Program("armcmc-replay"),
                       {"--data", dir_ / "packs.csv", "--config", dir_ / "own.toml", "--verify"});
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, HasSubstr("--verify needs an LCM log"));
}

TEST_F(VerifyTest, TheConfigurationFollowsFromThePlantOfTheLog) {
  Record();
  const test::Outcome o = test::RunProgram(test::Program("armcmc-replay"), {"--data", dir_ / "run.lcm", "--verify"});
  EXPECT_THAT(o.out, HasSubstr("configuration: hunt_crossley, by the plant of the log"));
  EXPECT_EQ(o.code, 1) << "the recorded run drew 600 and said that this was all, not that it was cut";
}

}  // namespace
}  // namespace armcmc::replay::verify_test
