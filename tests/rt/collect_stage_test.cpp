#include "armcmc/rt/collect_stage.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>

#include "armcmc/estimator_status_t.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "test_packs.hpp"

namespace armcmc::rt::collect_stage_test {
namespace {

constexpr Nanos kT = 100'000'000;

class CollectStageTest : public ::testing::Test {
 protected:
  CollectStageTest() { stage_->Begin(0); }

  bool Send(const data_pack_t& pack, Nanos arrival_ns) {
    bytes_ = test::Encode(pack);
    return stage_->Step({bytes_, arrival_ns});
  }
  std::optional<EventKind> NextEvent() {
    Event event;
    return events_.Take(&event) ? std::optional(event.kind) : std::nullopt;
  }
  bool silent() const { return counters_->collect.silent.load(); }

  std::unique_ptr<PackRing> ring_ = std::make_unique<PackRing>();
  std::unique_ptr<Counters> counters_ = std::make_unique<Counters>();
  EventLog events_;
  std::unique_ptr<CollectStage> stage_ = std::make_unique<CollectStage>(
      RtSettings{}, PackFormat{HuntCrossley::kInfo.plant, 2}, ring_.get(), counters_.get(), &events_);
  std::vector<std::uint8_t> bytes_;
};

TEST_F(CollectStageTest, HandsAGoodPackOnWithItsTimes) {
  ASSERT_TRUE(Send(test::ValidPack(1), 5000));
  const PackSlot* slot = ring_->Front();
  ASSERT_NE(slot, nullptr);
  EXPECT_EQ(slot->pack.seq, 1);
  EXPECT_EQ(slot->times.release_ns, 5000);
  EXPECT_EQ(slot->times.deadline_ns, 5000 + RtSettings{}.deadline_ns);
  EXPECT_GE(slot->times.end_ns[0], slot->times.start_ns[0]);
  EXPECT_EQ(counters_->collect.received.Get(), 1);
}

TEST_F(CollectStageTest, TellsOnceThatPacksShareMoreSamplesThanIsCountedOn) {
  const auto send = [this](std::int64_t seq, int stride, std::int64_t run_id = 1) {
    data_pack_t pack = test::ValidPack(seq, run_id);
    pack.t_last_s = 0.099 + 1e-3 * stride * static_cast<double>(seq - 1);
    pack.t_last_ns = 1'000'000'000 + static_cast<std::int64_t>(pack.t_last_s * 1e9);
    Send(pack, kT * seq);
    ring_->Pop();
  };
  const auto reported = [this] {
    std::vector<std::pair<std::int64_t, std::int64_t>> differ;
    for (Event event; events_.Take(&event);)
      if (event.kind == EventKind::kOverlapDiffers) differ.emplace_back(event.a, event.b);
    return differ;
  };
  using Differences = std::vector<std::pair<std::int64_t, std::int64_t>>;
  for (const std::int64_t seq : {1, 2, 5, 6}) send(seq, 100);
  EXPECT_EQ(reported(), Differences{}) << "also after a gap";
  for (const std::int64_t seq : {1, 2, 3}) send(seq, 130, 2);
  EXPECT_EQ(reported(), Differences{}) << "time between packs";
  for (const std::int64_t seq : {1, 2, 3, 6}) send(seq, 10, 3);
  EXPECT_EQ(reported(), (Differences{{10, 100}})) << "once a run";
  send(1, 10, 4);
  send(4, 10, 4);
  EXPECT_EQ(reported(), (Differences{{10, 100}}));

  PackFormat format{HuntCrossley::kInfo.plant, 2};
  format.overlap = 10;
  stage_ = std::make_unique<CollectStage>(RtSettings{}, format, ring_.get(), counters_.get(), &events_);
  stage_->Begin(0);
  for (const std::int64_t seq : {1, 2, 4}) send(seq, 10);
  EXPECT_EQ(reported(), Differences{});
  for (const std::int64_t seq : {1, 2}) send(seq, 5, 2);
  EXPECT_EQ(reported(), (Differences{{5, 10}}));
  for (const std::int64_t seq : {1, 2}) send(seq, 100, 3);
  EXPECT_EQ(reported(), (Differences{{100, 10}})) << "each recursion would leave samples out";
}

TEST_F(CollectStageTest, ALatePackKeepsTheDeadlineOfItsGridPoint) {
  Send(test::ValidPack(1), 0);
  ring_->Pop();
  ASSERT_TRUE(Send(test::ValidPack(2), kT + 30));
  EXPECT_EQ(ring_->Front()->times.release_ns, kT);
  EXPECT_EQ(ring_->Front()->times.lateness_ns, 30);
  EXPECT_EQ(ring_->Front()->times.arrival_ns, kT + 30);
  EXPECT_EQ(ring_->Front()->times.deadline_ns, kT + RtSettings{}.deadline_ns);
}

TEST_F(CollectStageTest, APackOfZerosIsADeadSensorAndIsRejected) {
  data_pack_t pack = test::ValidPack(1);
  for (int n = 0; n < pack.n_samples; ++n) pack.y[n] = pack.u[n][0] = pack.u[n][1] = 0.0;
  EXPECT_FALSE(Send(pack, 0));
  EXPECT_EQ(counters_->Rejected(RejectGroup::kValue), 1);
  pack.u[3][0] = 1e-12;  // at rest, and alive
  EXPECT_TRUE(Send(pack, 0));
}

TEST_F(CollectStageTest, FlagsAJumpOfThePlantsClockOnce) {
  Send(test::ValidPack(1), 0);
  data_pack_t pack = test::ValidPack(2);
  pack.t_last_ns -= 2 * kT;
  ASSERT_TRUE(Send(pack, kT)) << "its data are good";
  EXPECT_EQ(counters_->faults.Take(), estimator_status_t::FAULT_CLOCK_JUMP);
  pack = test::ValidPack(3);
  pack.t_last_ns -= 2 * kT;
  Send(pack, 2 * kT);
  EXPECT_EQ(counters_->faults.Take(), 0) << "it goes on from there";
}

TEST_F(CollectStageTest, ALostPackOrANewRunIsNoJumpOfTheClock) {
  Send(test::ValidPack(1), 0);
  Send(test::ValidPack(5), 4 * kT);
  data_pack_t restarted = test::ValidPack(1, /*run_id=*/2);
  restarted.t_last_ns += 1'000'000 * kT;
  Send(restarted, 5 * kT);
  EXPECT_EQ(counters_->faults.Take() & estimator_status_t::FAULT_CLOCK_JUMP, 0);
}

TEST_F(CollectStageTest, FlagsABusThatIsFloodedByOtherChannels) {
  stage_->NoteForeign(5'000'000, kT);  // whatever came before
  stage_->NoteForeign(5'000'000 + 900, 2 * kT);
  EXPECT_EQ(counters_->faults.Take(), 0) << "9 000 a second";
  stage_->NoteForeign(5'000'000 + 900 + 1100, 3 * kT);
  EXPECT_EQ(counters_->faults.Take(), estimator_status_t::FAULT_BUS_FLOOD) << "11 000 a second";
  stage_->NoteForeign(5'000'000 + 900 + 1100 + 2000, 13 * kT);
  EXPECT_EQ(counters_->faults.Take(), 0) << "2 000 a second, seen late";
}

TEST_F(CollectStageTest, CountsBadPacksByCauseAndGoesOn) {
  data_pack_t bad = test::ValidPack(1);
  bad.y[3] = std::nan("");
  EXPECT_FALSE(Send(bad, 0));
  bad = test::ValidPack(1);
  bad.n_samples = 300;
  EXPECT_FALSE(Send(bad, 0));
  bytes_.assign(100, 7);  // another type, or none
  EXPECT_FALSE(stage_->Step({bytes_, 0}));
  EXPECT_EQ(counters_->Rejected(RejectGroup::kValue), 1);
  EXPECT_EQ(counters_->Rejected(RejectGroup::kSize), 1);
  EXPECT_EQ(counters_->Rejected(RejectGroup::kType), 1);
  EXPECT_EQ(counters_->Rejected(), 3);
  EXPECT_EQ(counters_->faults.Take(), estimator_status_t::FAULT_BAD_DATA);
  EXPECT_EQ(NextEvent(), EventKind::kPackRejected);
  EXPECT_TRUE(Send(test::ValidPack(1), 0));
}

TEST_F(CollectStageTest, ARejectedPackIsNeitherLostNorAReasonForLateness) {
  Send(test::ValidPack(1), kT);
  data_pack_t bad = test::ValidPack(2);
  bad.y[3] = std::nan("");
  Send(bad, 2 * kT);
  ring_->Pop();
  ASSERT_TRUE(Send(test::ValidPack(3), 3 * kT));
  EXPECT_EQ(ring_->Front()->times.lateness_ns, 0);
  EXPECT_EQ(counters_->collect.lost.Get(), 0);
}

TEST_F(CollectStageTest, SkipsDuplicateAndReorderedPacks) {
  EXPECT_TRUE(Send(test::ValidPack(1), 0));
  EXPECT_TRUE(Send(test::ValidPack(3), 2 * kT));
  EXPECT_FALSE(Send(test::ValidPack(3), 2 * kT + 1));
  EXPECT_FALSE(Send(test::ValidPack(2), 2 * kT + 2));
  EXPECT_EQ(counters_->collect.duplicate.Get(), 1);
  EXPECT_EQ(counters_->collect.reordered.Get(), 1);
  EXPECT_EQ(ring_->size(), 2U);
}

TEST_F(CollectStageTest, FlagsASilentPlantWithinTwoPeriodsAndSaysOnceThatItIsSilentAndBack) {
  Send(test::ValidPack(1), kT);
  EXPECT_EQ(NextEvent(), EventKind::kPlantFirstSeen);
  EXPECT_FALSE(silent());
  EXPECT_LE(stage_->next_tick_ns(), kT + 2 * kT);
  for (int i = 0; i < 5; ++i) stage_->Tick(stage_->next_tick_ns());
  EXPECT_TRUE(silent());
  EXPECT_EQ(counters_->collect.silent_periods.Get(), 5);
  EXPECT_EQ(NextEvent(), EventKind::kPlantSilent);
  EXPECT_EQ(NextEvent(), std::nullopt);
  Send(test::ValidPack(2), 10 * kT);
  Send(test::ValidPack(3), 11 * kT);
  EXPECT_FALSE(silent());
  EXPECT_EQ(NextEvent(), EventKind::kPlantBack);
  EXPECT_EQ(NextEvent(), std::nullopt);
}

TEST_F(CollectStageTest, WaitsForThePlantWithoutCountingSilentPeriods) {
  for (int i = 0; i < 5; ++i) stage_->Tick(stage_->next_tick_ns());
  EXPECT_TRUE(silent());
  EXPECT_EQ(counters_->collect.silent_periods.Get(), 0);
  EXPECT_EQ(NextEvent(), EventKind::kWaitingForPlant);
  EXPECT_EQ(NextEvent(), std::nullopt);
}

TEST_F(CollectStageTest, APlantThatSendsNonsenseIsNotSilent) {
  Send(test::ValidPack(1), kT);
  data_pack_t bad = test::ValidPack(2);
  bad.dt = 0.0;
  Send(bad, 2 * kT);
  stage_->Tick(stage_->next_tick_ns());
  EXPECT_FALSE(silent());
  EXPECT_EQ(counters_->collect.silent_periods.Get(), 0);
}

TEST_F(CollectStageTest, ARestartedPlantIsFlaggedAndGetsANewGrid) {
  Send(test::ValidPack(50, 1), kT);
  ASSERT_TRUE(Send(test::ValidPack(1, 2), 7 * kT + 33));
  EXPECT_EQ(counters_->collect.restarts.Get(), 1);
  EXPECT_EQ(counters_->collect.lost.Get(), 0);
  EXPECT_EQ(counters_->faults.Take(), estimator_status_t::FAULT_PLANT_RESTARTED);
  ring_->Pop();
  EXPECT_EQ(ring_->Front()->times.lateness_ns, 0);
}

TEST_F(CollectStageTest, CountsWhatDoesNotFitIntoTheRing) {
  for (std::int64_t seq = 1; seq <= static_cast<std::int64_t>(kPackRingCapacity); ++seq) {
    EXPECT_TRUE(Send(test::ValidPack(seq), seq * kT));
  }
  const auto next = static_cast<std::int64_t>(kPackRingCapacity) + 1;
  EXPECT_FALSE(Send(test::ValidPack(next), next * kT));
  EXPECT_EQ(counters_->Dropped(), 1);
  EXPECT_EQ(counters_->faults.Take(), estimator_status_t::FAULT_BACKLOG);
}

}  // namespace
}  // namespace armcmc::rt::collect_stage_test
