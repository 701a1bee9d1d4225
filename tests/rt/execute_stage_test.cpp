#include "armcmc/rt/execute_stage.hpp"

#include <gtest/gtest.h>

#include "stage_rig.hpp"

namespace armcmc::rt::execute_stage_test {
namespace {

class ExecuteStageTest : public test::StageRig {
 protected:
  /// One pack through adjust and execute.
  void Step(std::int64_t seq, Nanos deadline_from_now_ns) {
    Push(seq, deadline_from_now_ns);
    ASSERT_TRUE(adjust_.Step());
    ASSERT_TRUE(execute_.Step());
  }
};

TEST_F(ExecuteStageTest, SummarisesEveryResultOnceAndCountsWhatWasDrawn) {
  EXPECT_FALSE(execute_.Step()) << "there is no result";
  Step(7, test::kHour);
  EXPECT_FALSE(execute_.Step()) << "one result, one step";
  const StepOutput* output = outputs_->Front();
  ASSERT_NE(output, nullptr);
  EXPECT_EQ(output->info.seq, 7);
  EXPECT_EQ(output->estimate.seq, 7) << "of the slot that was handed over";
  EXPECT_EQ(output->miss, MissCause::kNone);
  EXPECT_GE(output->info.times.start_ns[2], output->info.times.end_ns[1]);
  EXPECT_GE(output->info.times.end_ns[2], output->info.times.start_ns[2]);
  EXPECT_EQ(counters_->execute.steps.Get(), 1);
  EXPECT_EQ(counters_->execute.last_seq.Get(), 7);
  EXPECT_EQ(execute_.draws().max(), 1000.0);
  EXPECT_EQ(execute_.ess().max(), 500.0);
}

TEST_F(ExecuteStageTest, TellsWhichDeadlineWasMissedByHowMuchAndWhy) {
  Step(7, -test::kHour);
  EXPECT_EQ(outputs_->Front()->miss, MissCause::kOwn);
  EXPECT_EQ(monitor_->misses(MissCause::kOwn), 1);
  Event event;
  ASSERT_TRUE(events_.Take(&event));
  EXPECT_EQ(event.kind, EventKind::kDeadlineMissed);
  EXPECT_EQ(event.detail, static_cast<std::uint8_t>(MissCause::kOwn));
  EXPECT_EQ(event.a, 7);
  EXPECT_GE(event.b, test::kHour);
}

TEST_F(ExecuteStageTest, GoesOnWhileThePublisherIsStuckAndCountsWhatItCannotTake) {
  const auto room = static_cast<std::int64_t>(kOutputRingCapacity);
  for (std::int64_t seq = 1; seq <= room + 2; ++seq) Step(seq, test::kHour);
  EXPECT_EQ(counters_->execute.steps.Get(), room + 2);
  EXPECT_EQ(counters_->execute.unpublished.Get(), 2);
  EXPECT_EQ(monitor_->end_to_end().count(), kOutputRingCapacity + 2) << "judged all the same";
  outputs_->Pop();
  Step(room + 3, test::kHour);
  EXPECT_EQ(counters_->execute.unpublished.Get(), 2) << "there is room again";
}

}  // namespace
}  // namespace armcmc::rt::execute_stage_test
