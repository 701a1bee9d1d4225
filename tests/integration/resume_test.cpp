#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "armcmc/estimate_t.hpp"
#include "integration/live_pair.hpp"

namespace armcmc::test::resume_test {
namespace {

using namespace std::chrono_literals;

class Resume : public LivePair {
 protected:
  [[nodiscard]] std::string File() const { return dir_ / "learnt.snapshot"; }

  /// Estimates that came after the first `before`.
  std::vector<estimate_t> Since(std::size_t before) {
    const auto all = recorder_->estimates();
    return {all.begin() + static_cast<std::ptrdiff_t>(before), all.end()};
  }
};

TEST_F(Resume, AfterKill9TheEstimatorGoesOnFromWhatItHadLearnt) {
  auto first = StartEstimator({"--resume", File()});
  EXPECT_TRUE(first->WaitForErr("starting afresh", 5s)) << first->err();
  auto plant = StartPlant("60");
  ASSERT_TRUE(recorder_->WaitForEstimates(17)) << first->err();
  // The file is replaced once a second: killed right after that, it holds nearly all that was learnt.
  const auto replaced = [this] {
    std::error_code none;
    return std::filesystem::last_write_time(File(), none);
  };
  ASSERT_TRUE(recorder_->WaitUntil([&, old = replaced()] { return replaced() != old; })) << first->err();
  first->Signal(SIGKILL);
  EXPECT_EQ(first->Wait(5s).signal, SIGKILL);
  const std::size_t before = recorder_->estimates().size();
  const estimate_t learnt = recorder_->estimates().back();
  ASSERT_TRUE(std::filesystem::exists(File()));

  auto second = StartEstimator({"--resume", File()});
  // Packs out of contact say nothing: until one came that says something.
  const auto says = [](const estimate_t& e) { return e.decision != estimate_t::DECISION_HOLD; };
  std::vector<estimate_t> since;
  ASSERT_TRUE(recorder_->WaitUntil([&] {
    since = Since(before);
    return since.size() >= 5 && std::any_of(since.begin(), since.end(), says);
  })) << second->err();
  EXPECT_TRUE(second->WaitForErr("continuing from pack", 1s)) << second->err();
  EXPECT_EQ(since.front().known, 1) << "from its first word on";
  const auto judged = std::find_if(since.begin(), since.end(), says);
  EXPECT_EQ(judged->decision, estimate_t::DECISION_REINFORCEMENT) << "who knows nothing starts with a modification";
  EXPECT_LE(judged->q75[0] - judged->q25[0], 2.0 * (learnt.q75[0] - learnt.q25[0]));
  plant->Signal(SIGINT);
  EXPECT_EQ(plant->Wait(30s).code, 0) << plant->err();
  const Json report = Finish(second.get());
  EXPECT_GT(report["snapshot"]["resumed_from_pack"], 0);
  EXPECT_GT(report["snapshot"]["written"], 0);
  EXPECT_EQ(report["snapshot"]["failed"], 0);
  for (const char* stage : {"collect", "adjust", "execute"}) {
    const Json calls = report["allocations"][stage];
    EXPECT_TRUE(calls.is_null() || calls == 0) << stage << ": " << calls;
  }
}

TEST_F(Resume, ADamagedSnapshotAndOneOfAnotherModelAreRefusedAndTheRunGoesOn) {
  std::ofstream(File()) << "ARMCMCSN and no more";
  auto first = StartEstimator({"--resume", File()});
  EXPECT_TRUE(first->WaitForErr("is refused, it is truncated; starting afresh", 5s)) << first->err();
  ASSERT_EQ(Play("0.8"), 8u) << first->err();
  first->Signal(SIGINT);
  EXPECT_EQ(first->Wait(10s).code, 0) << first->err();

  Process other(Program("armcmc-estimator"), {"--config", (SourceDir() / "rt/config/soft_actuator.toml").string(),
                                              "--lcm-url", bus_->url(), "--resume", File()});
  EXPECT_TRUE(other.WaitForErr("is refused, it belongs to another model", 5s)) << other.err();
  EXPECT_TRUE(other.running());
  other.Signal(SIGINT);
  EXPECT_EQ(other.Wait(10s).code, 0) << other.err();
}

TEST_F(Resume, AnotherFileIsLeftAloneAndTheRunDoesNotBegin) {
  const std::string table = "t,x,y\n0,1,2\n";
  std::ofstream(File()) << table;
  const Outcome o = RunProgram(Program("armcmc-estimator"), {"--lcm-url", bus_->url(), "--resume", File()});
  EXPECT_EQ(o.code, 2);
  EXPECT_NE(o.err.find("--resume " + File() + ": not a snapshot of an estimator; it is left as it is"),
            std::string::npos)
      << o.err;
  std::stringstream kept;
  kept << std::ifstream(File()).rdbuf();
  EXPECT_EQ(kept.str(), table);
  EXPECT_FALSE(std::filesystem::exists(File() + ".refused"));
}

TEST_F(Resume, ADiskThatRefusesIsPublishedAndCountedAndNothingElseHappens) {
  const auto folder = dir_ / "gone";
  std::filesystem::create_directories(folder);
  auto estimator = StartEstimator({"--resume", (folder / "learnt.snapshot").string()});
  std::filesystem::remove_all(folder);
  ASSERT_EQ(Play("0.5"), 5u) << estimator->err();
  EXPECT_TRUE(estimator->WaitForErr("cannot be written", 5s)) << estimator->err();
  EXPECT_TRUE(recorder_->WaitUntil([this] {
    const auto all = recorder_->statuses();
    return std::any_of(all.begin(), all.end(), [](const estimator_status_t& s) {
      return (s.fault_flags & estimator_status_t::FAULT_SNAPSHOT) != 0;
    });
  }));
  const Json report = Finish(estimator.get());
  EXPECT_GT(report["snapshot"]["failed"], 0);
  EXPECT_EQ(report["packs"]["lost"], 0);
}

}  // namespace
}  // namespace armcmc::test::resume_test
