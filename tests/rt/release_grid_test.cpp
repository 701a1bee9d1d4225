#include "armcmc/rt/release_grid.hpp"

#include <gtest/gtest.h>

namespace armcmc::rt::release_grid_test {
namespace {

TEST(NextRelease, IsTheNextPointOfTheGridAndCountsWhatPassed) {
  const auto next = [](Nanos now_ns) { return NextRelease(/*release_ns=*/100, now_ns, /*period_ns=*/100); };
  EXPECT_EQ(next(150).time_ns, 200);
  EXPECT_EQ(next(200).time_ns, 200) << "just in time";
  EXPECT_EQ(next(200).missed, 0U);
  EXPECT_EQ(next(450).time_ns, 500);
  EXPECT_EQ(next(450).missed, 3U);
}

TEST(ReleaseGrid, ReleasesAPackThatIsOnTimeAtItsArrivalAndMovesWithOneThatIsEarly) {
  ReleaseGrid grid(100);
  EXPECT_EQ(grid.Lock(1000).release_ns, 1000);
  EXPECT_EQ(grid.OnPack(1, 1100).release_ns, 1100);
  EXPECT_EQ(grid.next_due_ns(), 1200);
  const auto early = grid.OnPack(1, 1170);
  EXPECT_EQ(early.release_ns, 1170);
  EXPECT_EQ(early.lateness_ns, 0);
  EXPECT_EQ(grid.next_due_ns(), 1270);
}

TEST(ReleaseGrid, ReleasesALatePackAtItsGridPointSoThatItsLatenessShows) {
  ReleaseGrid grid(100);
  grid.Lock(1000);
  const auto point = grid.OnPack(1, 1160);
  EXPECT_EQ(point.release_ns, 1100);
  EXPECT_EQ(point.lateness_ns, 60);
  EXPECT_EQ(grid.next_due_ns(), 1200) << "one late pack does not move the grid";
}

TEST(ReleaseGrid, CountsLostPacksAsPassedGridPoints) {
  ReleaseGrid grid(100);
  grid.Lock(1000);
  EXPECT_EQ(grid.OnPack(5, 1510).lateness_ns, 10);
}

TEST(ReleaseGrid, FollowsAPhaseThatStaysLateAfterAWindow) {
  ReleaseGrid grid(100);
  grid.Lock(1000);
  Nanos arrival = 1040;
  for (int i = 0; i < ReleaseGrid::kWindow; ++i) EXPECT_EQ(grid.OnPack(1, arrival += 100).lateness_ns, 40);
  EXPECT_EQ(grid.OnPack(1, arrival += 100).lateness_ns, 0);
}

TEST(ReleaseGrid, KeepsItsPhaseWhenOnlySomePacksAreLate) {
  ReleaseGrid grid(100);
  grid.Lock(1000);
  Nanos due = 1000;
  for (int i = 1; i <= 50; ++i) {
    due += 100;
    const Nanos jitter = i % 4 == 0 ? 0 : 30;
    EXPECT_EQ(grid.OnPack(1, due + jitter).lateness_ns, jitter);
  }
}

TEST(ReleaseGrid, RelocksAfterAPauseOnceTheLatenessWasReported) {
  ReleaseGrid grid(100);
  grid.Lock(1000);
  const auto point = grid.OnPack(1, 3345);
  EXPECT_EQ(point.release_ns, 1100);
  EXPECT_EQ(point.lateness_ns, 2245);
  EXPECT_EQ(grid.next_due_ns(), 3445) << "a period after one that came far too late";
  EXPECT_EQ(grid.OnPack(1, 3445).lateness_ns, 0);
}

TEST(ReleaseGrid, DoesNotTakeABurstThatCatchesUpForANewPhase) {
  ReleaseGrid grid(100);
  grid.Lock(1000);
  EXPECT_EQ(grid.OnPack(1, 1480).lateness_ns, 380);
  EXPECT_EQ(grid.OnPack(1, 1481).lateness_ns, 281) << "late on the old grid, not early on a new one";
  EXPECT_EQ(grid.OnPack(1, 1482).lateness_ns, 182);
  EXPECT_EQ(grid.OnPack(1, 1483).lateness_ns, 83);
  EXPECT_EQ(grid.OnPack(1, 1500).lateness_ns, 0) << "caught up";
  EXPECT_EQ(grid.OnPack(1, 1600).lateness_ns, 0);
}

TEST(ReleaseGrid, KeepsItsPhaseThroughALongBurst) {
  ReleaseGrid grid(100);
  grid.Lock(1000);
  EXPECT_EQ(grid.OnPack(1, 6100).lateness_ns, 5000);
  for (Nanos i = 1; i <= 40; ++i) EXPECT_EQ(grid.OnPack(1, 6100 + i).lateness_ns, 5000 - 99 * i);
}

TEST(ReleaseGrid, ReturnsWhenThePlantOnlyHesitatedWhileItCaughtUp) {
  ReleaseGrid grid(100);
  grid.Lock(1000);
  EXPECT_EQ(grid.OnPack(1, 6100).lateness_ns, 5000);
  const auto moved = grid.OnPack(1, 6160);
  EXPECT_EQ(moved.lateness_ns, 0) << "a new phase, it seems";
  EXPECT_EQ(moved.unsettled_ns, 4960) << "if it is none";
  EXPECT_EQ(grid.OnPack(1, 6170).lateness_ns, 4870) << "no: 90 early, and so late on the grid that was left";
  for (Nanos i = 1; i <= 40; ++i) EXPECT_EQ(grid.OnPack(1, 6170 + 10 * i).lateness_ns, 4870 - 90 * i);
}

TEST(ReleaseGrid, ReturnsAlsoAfterAStutterOfManyPacks) {
  constexpr Nanos kMs = 1'000'000;
  ReleaseGrid grid(kMs);
  grid.Lock(100 * kMs);
  grid.OnPack(1, 110 * kMs);
  Nanos arrival = 110 * kMs;
  // The machine stutters: twenty packs keep a phase that is 9 ms late, then the plant sends what it owes.
  for (int i = 0; i < 20; ++i) EXPECT_EQ(grid.OnPack(1, arrival += kMs).lateness_ns, 0);
  arrival += kMs / 5;
  EXPECT_EQ(grid.OnPack(1, arrival).lateness_ns, arrival - 122 * kMs);
  // One that is refuted by nothing is the phase of the plant, and a pack that comes early later on is just early.
  arrival = 300 * kMs;
  for (int i = 0; i < 200; ++i) grid.OnPack(1, arrival += kMs);
  EXPECT_EQ(grid.OnPack(1, arrival + kMs / 5).lateness_ns, 0);
}

TEST(ReleaseGrid, ReturnsFromTwoHesitationsToTheFirstGrid) {
  ReleaseGrid grid(100);
  grid.Lock(1000);
  grid.OnPack(1, 6100);
  EXPECT_EQ(grid.OnPack(1, 6160).lateness_ns, 0);
  EXPECT_EQ(grid.OnPack(1, 6400).lateness_ns, 140);
  EXPECT_EQ(grid.OnPack(1, 6460).lateness_ns, 0);
  EXPECT_EQ(grid.OnPack(1, 6465).lateness_ns, 6465 - 1500);
}

TEST(ReleaseGrid, KeepsANewPhaseThatHeldForAWindow) {
  constexpr Nanos kMs = 1'000'000;
  static_assert(ReleaseGrid::kSettleNs / (100 * kMs) < ReleaseGrid::kWindow);
  ReleaseGrid grid(100 * kMs);
  grid.Lock(1000 * kMs);
  grid.OnPack(1, 6100 * kMs);
  Nanos due = 6100 * kMs;
  for (int i = 0; i < ReleaseGrid::kWindow + 1; ++i) EXPECT_EQ(grid.OnPack(1, due += 100 * kMs).lateness_ns, 0);
  EXPECT_EQ(grid.OnPack(1, due + 20 * kMs).lateness_ns, 0) << "early, and the phase moves with it";
  const auto settled = grid.OnPack(1, due + 120 * kMs);
  EXPECT_EQ(settled.lateness_ns, 0);
  EXPECT_EQ(settled.unsettled_ns, 0);
}

TEST(ReleaseGrid, KeepsANewPhaseWhenAPackIsALittleEarly) {
  ReleaseGrid grid(100);
  grid.Lock(1000);
  grid.OnPack(1, 6100);
  EXPECT_EQ(grid.OnPack(1, 6200).lateness_ns, 0);
  EXPECT_EQ(grid.OnPack(1, 6260).lateness_ns, 0);
  EXPECT_EQ(grid.OnPack(1, 6360).lateness_ns, 0);
}

}  // namespace
}  // namespace armcmc::rt::release_grid_test
