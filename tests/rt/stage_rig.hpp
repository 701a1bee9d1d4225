#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>

#include "armcmc/rt/adjust_stage.hpp"
#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/execute_stage.hpp"
#include "fake_engine.hpp"

namespace armcmc::rt::test {

// Deadlines lie hours in the past or in the future: how fast the machine runs decides nothing.
inline constexpr Nanos kHour = 3600 * kNanosPerSecond;

/// The stages behind collect, without threads.
class StageRig : public ::testing::Test {
 protected:
  /// Hands adjust a pack that just came.
  void Push(std::int64_t seq, Nanos deadline_from_now_ns) {
    PackSlot* slot = ring_->Claim();
    ASSERT_NE(slot, nullptr);
    const Nanos now = MonotonicNow();
    slot->pack.seq = seq;
    slot->pack.num_samples = 1;
    slot->times = {};
    slot->times.release_ns = slot->times.arrival_ns = now;
    slot->times.deadline_ns = now + deadline_from_now_ns;
    slot->times.start_ns[0] = slot->times.end_ns[0] = now;
    ring_->Commit();
  }

  RtSettings settings_;
  FakeEngine engine_;
  std::unique_ptr<PackRing> ring_ = std::make_unique<PackRing>();
  std::unique_ptr<ResultHandOver> results_ = std::make_unique<ResultHandOver>();
  std::unique_ptr<OutputRing> outputs_ = std::make_unique<OutputRing>();
  std::unique_ptr<DeadlineMonitor> monitor_ = std::make_unique<DeadlineMonitor>(settings_);
  std::unique_ptr<Counters> counters_ = std::make_unique<Counters>();
  EventLog events_;
  AdjustStage adjust_{settings_, &engine_, ring_.get(), results_.get(), monitor_.get(), counters_.get(), &events_};
  ExecuteStage execute_{&engine_, results_.get(), outputs_.get(), monitor_.get(), counters_.get(), &events_};
};

}  // namespace armcmc::rt::test
