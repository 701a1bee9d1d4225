// Several plants in one pipeline.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "armcmc/estimate_t.hpp"
#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/pipeline.hpp"
#include "fake_engine.hpp"
#include "support/paths.hpp"
#include "test_bus.hpp"
#include "test_packs.hpp"

namespace armcmc::rt::lanes_test {
namespace {

TEST(FairDeadline, SharesTheTimeAmongThoseThatWait) {
  static_assert(FairDeadline(100, 180, 1) == 180);
  static_assert(FairDeadline(100, 180, 4) == 120);
  EXPECT_EQ(FairDeadline(100, 180, 0), 180);
  // Plants that take their share one after the other end by the deadline of all.
  Nanos now = 0;
  for (int waiting = 7; waiting > 0; --waiting) now = FairDeadline(now, 700, waiting);
  EXPECT_EQ(now, 700);
}

RtSettings Settings(const std::string& url) {
  RtSettings settings;
  settings.lcm_url = url;
  settings.lock_memory = false;
  settings.period_ns = 50 * kNanosPerMilli;
  settings.deadline_ns = 500 * kNanosPerMilli;  // wide: not what these tests are about
  settings.adjust_budget_ns = 40 * kNanosPerMilli;
  return settings;
}

class LanesTest : public ::testing::Test {
 protected:
  static constexpr std::size_t kPlants = 3;

  void SetUp() override {
    ARMCMC_REQUIRE_MULTICAST();
    peer_ = std::make_unique<test::Peer>(bus_.url());
    std::vector<LanePlant> plants;
    for (std::size_t i = 0; i < kPlants; ++i) plants.push_back({&engines_[i], Prefix(i), false});
    pipeline_ = std::make_unique<Pipeline>(Settings(bus_.url()), plants, PipelineOptions{});
    receiver_ = std::make_unique<LcmReceiver>(
        ParseLcmUrl(bus_.url()), std::vector<std::string>{"P0_EST_ESTIMATE", "P1_EST_ESTIMATE", "P2_EST_ESTIMATE"});
    pipeline_->Start();
  }
  void TearDown() override {
    if (!pipeline_) return;
    pipeline_->RequestStop();
    pipeline_->Join();
  }

  static std::string Prefix(std::size_t i) { return "P" + std::to_string(i) + "_"; }
  void Publish(std::size_t plant, std::int64_t seq) {
    peer_->Publish(Prefix(plant) + "PLANT_PACK", test::Encode(test::ValidPack(seq)));
  }
  /// Estimates received so far, by plant.
  const std::array<std::vector<estimate_t>, kPlants>& Received() {
    Datagram datagram;
    while (receiver_->TryReceive(&datagram)) {
      estimate_t estimate;
      EXPECT_GT(estimate.decode(datagram.payload.data(), 0, static_cast<int>(datagram.payload.size())), 0);
      received_[datagram.channel].push_back(estimate);
    }
    return received_;
  }
  static bool WaitFor(const std::function<bool()>& condition) {
    for (const Nanos end = MonotonicNow() + test::kLong; MonotonicNow() < end;
         SleepUntil(MonotonicNow() + kNanosPerMilli))
      if (condition()) return true;
    return false;
  }
  /// Collect begins to listen some time after Start(): packs until each plant was heard once.
  void WaitUntilAllAnswer() {
    std::int64_t seq = 0;
    ASSERT_TRUE(WaitFor([&] {
      ++seq;
      for (std::size_t i = 0; i < kPlants; ++i)
        if (Received()[i].empty()) Publish(i, seq);
      SleepUntil(MonotonicNow() + 20 * kNanosPerMilli);
      return std::none_of(Received().begin(), Received().end(), [](const auto& of) { return of.empty(); });
    }));
  }

  armcmc::test::TestBus bus_;
  std::array<test::FakeEngine, kPlants> engines_;
  std::unique_ptr<test::Peer> peer_;
  std::unique_ptr<Pipeline> pipeline_;
  std::unique_ptr<LcmReceiver> receiver_;
  std::array<std::vector<estimate_t>, kPlants> received_;
};

TEST_F(LanesTest, EveryPlantHasItsOwnAnswersAndCounts) {
  WaitUntilAllAnswer();
  std::array<std::int64_t, kPlants> before{};
  for (std::size_t i = 0; i < kPlants; ++i) before[i] = pipeline_->lane(i).counters().collect.received.Get();
  // Numbers far apart tell whose answer it is.
  for (std::int64_t k = 1; k <= 3; ++k)
    for (std::size_t i = 0; i <= static_cast<std::size_t>(k) % kPlants; ++i)
      Publish(i, 1000 * static_cast<std::int64_t>(i + 1) + k);
  const auto sent = [](std::size_t i) { return i == 0 ? 3 : i == 1 ? 2 : 1; };
  ASSERT_TRUE(WaitFor([&] {
    for (std::size_t i = 0; i < kPlants; ++i)
      if (pipeline_->lane(i).counters().collect.received.Get() < before[i] + sent(i) ||
          Received()[i].back().seq < 1000 * static_cast<std::int64_t>(i + 1))
        return false;
    return true;
  }));
  for (std::size_t i = 0; i < kPlants; ++i) {
    EXPECT_EQ(pipeline_->lane(i).counters().collect.received.Get(), before[i] + sent(i)) << i;
    for (const estimate_t& estimate : Received()[i]) {
      if (estimate.seq > 100) {
        EXPECT_EQ(estimate.seq / 1000, static_cast<std::int64_t>(i) + 1);
      }
    }
    // What the newest pack leaves is remembered once nothing else waits.
    EXPECT_TRUE(WaitFor([&] { return engines_[i].remembered.load() >= sent(i); })) << i;
  }
}

TEST_F(LanesTest, PlantsThatWaitShareTheTime) {
  WaitUntilAllAnswer();
  // While the first is busy packs of all come in; each of the waiting gets a part of the budget.
  engines_[0].adjust_sleep_ns = 200 * kNanosPerMilli;
  Publish(0, 501);
  ASSERT_TRUE(WaitFor(
      [&] { return pipeline_->lane(0).counters().collect.received.Get() > 0 && engines_[0].adjusted.load() > 0; }));
  SleepUntil(MonotonicNow() + 20 * kNanosPerMilli);
  engines_[0].adjust_sleep_ns = 0;
  for (std::size_t i = 0; i < kPlants; ++i) Publish(i, 502);
  ASSERT_TRUE(WaitFor([&] {
    return std::all_of(Received().begin(), Received().end(), [](const auto& of) { return of.back().seq >= 502; });
  }));
  std::array<Nanos, kPlants> budgets{};
  for (std::size_t i = 0; i < kPlants; ++i) budgets[i] = engines_[i].last_budget_ns.load();
  std::sort(budgets.begin(), budgets.end());
  // Two at least: the first may have to wait until its result of before is taken.
  EXPECT_LE(budgets[0], 40 * kNanosPerMilli / 2);
  EXPECT_LE(budgets[2], 40 * kNanosPerMilli);
}

TEST(Lanes, RefusesWhatCannotBeToldApart) {
  test::FakeEngine a, b;
  const RtSettings settings = Settings("udpm://239.255.76.67:21001?ttl=0");
  EXPECT_THROW(Pipeline(settings, {{&a, "A_", false}, {&b, "A_", false}}, {}), std::invalid_argument);
  EXPECT_THROW(Pipeline(settings, std::vector<LanePlant>{}, {}), std::invalid_argument);
  std::vector<LanePlant> many;
  for (std::size_t i = 0; i <= Pipeline::kMaxLanes; ++i) many.push_back({&a, "P" + std::to_string(i), false});
  EXPECT_THROW(Pipeline(settings, many, {}), std::invalid_argument);
  Injection injection({});
  PipelineOptions options;
  options.injection = &injection;
  EXPECT_THROW(Pipeline(settings, {{&a, "A_", false}, {&b, "B_", false}}, options), std::invalid_argument);
}

}  // namespace
}  // namespace armcmc::rt::lanes_test
