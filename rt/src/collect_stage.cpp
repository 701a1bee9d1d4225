#include "armcmc/rt/collect_stage.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/estimator_status_t.hpp"
#include "armcmc/rt/clock.hpp"

namespace armcmc::rt {
namespace {

/// Shortest silence that is worth a line of text; the status flags shorter ones too.
constexpr Nanos kShortestReportedSilence = 20 * kNanosPerMilli;

/// A pack may come this late before its period counts as silent: three quarters of the period, so that a plant that
/// stops is flagged within two periods of its last pack.
constexpr Nanos SilenceMargin(Nanos period_ns) noexcept { return 3 * period_ns / 4; }

}  // namespace

CollectStage::CollectStage(const RtSettings& settings, const PackFormat& format, PackRing* ring, Counters* counters,
                           EventLog* events) noexcept
    : period_ns_(settings.period_ns),
      deadline_ns_(settings.deadline_ns),
      overlap_(format.overlap),
      codec_(format),
      grid_(settings.period_ns),
      ring_(ring),
      counters_(counters),
      events_(events) {}

void CollectStage::Begin(Nanos now_ns) noexcept {
  heard_ns_ = now_ns;
  next_tick_ns_ = now_ns + period_ns_;
}

void CollectStage::PublishSequenceCounts() noexcept {
  auto& count = counters_->collect;
  count.lost.Set(tracker_.counts().lost);
  count.duplicate.Set(tracker_.counts().duplicate);
  count.reordered.Set(tracker_.counts().reordered);
  count.restarts.Set(tracker_.counts().restarts);
}

void CollectStage::Reject(RejectCause cause, Nanos now_ns) noexcept {
  counters_->collect.rejected[static_cast<std::size_t>(cause)].Add();
  counters_->faults.Raise(estimator_status_t::FAULT_BAD_DATA);
  events_->Add({now_ns, EventKind::kPackRejected, 0, static_cast<std::int64_t>(cause), 0});
  if (codec_.decoded()) {
    skipped_steps_ += tracker_.OnUnusable(codec_.seq(), codec_.run_id());
    PublishSequenceCounts();
  }
}

void CollectStage::NoteClock(bool continues, Nanos now_ns) noexcept {
  // The plant tells its time twice: on its clock, and since its start. Between two packs both advance by as much.
  const double clock_ns = static_cast<double>(codec_.t_last_ns()) - static_cast<double>(plant_clock_ns_);
  const double jump_ns = clock_ns - (codec_.t_last_s() - plant_time_s_) * static_cast<double>(kNanosPerSecond);
  if (continues && std::fabs(jump_ns) > static_cast<double>(period_ns_)) {
    counters_->faults.Raise(estimator_status_t::FAULT_CLOCK_JUMP);
    const double bounded = std::clamp(jump_ns, -9e18, 9e18);
    events_->Add({now_ns, EventKind::kClockJumped, 0, codec_.seq(), static_cast<std::int64_t>(bounded)});
  }
  plant_clock_ns_ = codec_.t_last_ns();
  plant_time_s_ = codec_.t_last_s();
}

void CollectStage::NoteOverlap(std::int64_t steps, Nanos now_ns) noexcept {
  if (overlap_told_) return;
  const double expected = static_cast<double>(codec_.num_samples()) / overlap_;
  const double stride = (codec_.t_last_s() - plant_time_s_) / (codec_.dt() * static_cast<double>(steps));
  // Packs that do not overlap may leave time between them.
  const bool differs = stride < expected - 0.5 || (overlap_ > 1 && stride > expected + 0.5);
  if (!differs || !(std::fabs(stride) < 1e9)) return;
  overlap_told_ = true;
  events_->Add({now_ns, EventKind::kOverlapDiffers, 0, std::llround(stride), std::llround(expected)});
}

void CollectStage::NoteForeign(std::int64_t foreign, Nanos now_ns) noexcept ARMCMC_NONBLOCKING {
  const Nanos window_ns = now_ns - foreign_since_ns_;
  if (window_ns < std::max(period_ns_, kNanosPerSecond / 10)) return;
  const std::int64_t heard = foreign - foreign_before_;
  // A window that a stall made longer holds what had come meanwhile: still a rate.
  if (foreign_since_ns_ > 0 && heard > kFloodPerSecond * (window_ns / kNanosPerMilli) / 1000) {
    counters_->faults.Raise(estimator_status_t::FAULT_BUS_FLOOD);
    events_->Add({now_ns, EventKind::kBusFlooded, 0, heard, window_ns});
  }
  foreign_before_ = foreign;
  foreign_since_ns_ = now_ns;
}

void CollectStage::NoteSilenceOver(std::int64_t seq, Nanos now_ns) noexcept {
  if (silence_reported_ && grid_.locked()) {
    events_->Add({now_ns, EventKind::kPlantBack, 0, seq, silent_in_a_row_});
  }
  silence_reported_ = false;
  silent_in_a_row_ = 0;
  counters_->collect.silent.store(false, std::memory_order_relaxed);
}

bool CollectStage::Step(const Datagram& datagram) noexcept {
  cpu_time_.NoteWoken(datagram.arrival_ns);
  const Nanos start_ns = cpu_time_.Start();
  traffic_ = true;
  const RejectCause cause = codec_.Decode(datagram.payload);
  if (cause != RejectCause::kNone) {
    Reject(cause, start_ns);
    return false;
  }
  auto& count = counters_->collect;
  const std::int64_t lost_before = tracker_.counts().lost;
  const SequenceTracker::Result sequence = tracker_.OnPack(codec_.seq(), codec_.run_id());
  PublishSequenceCounts();
  if (!IsUsable(sequence.verdict)) return false;
  if (tracker_.counts().lost > lost_before) {
    events_->Add({start_ns, EventKind::kPacksLost, 0, tracker_.counts().lost - lost_before, codec_.seq()});
  }

  NoteSilenceOver(codec_.seq(), start_ns);
  ReleaseGrid::Point point;
  if (sequence.verdict == SequenceVerdict::kNext) {
    point = grid_.OnPack(sequence.steps + skipped_steps_, datagram.arrival_ns);
  } else {
    if (sequence.verdict == SequenceVerdict::kRestart) {
      counters_->faults.Raise(estimator_status_t::FAULT_PLANT_RESTARTED);
      events_->Add({start_ns, EventKind::kPlantRestarted, 0, codec_.seq(), codec_.run_id()});
    } else {
      events_->Add({start_ns, EventKind::kPlantFirstSeen, 0, codec_.seq(), 0});
    }
    point = grid_.Lock(datagram.arrival_ns);
  }
  if (sequence.verdict == SequenceVerdict::kNext) {
    NoteOverlap(sequence.steps + skipped_steps_, start_ns);
  } else {
    overlap_told_ = false;
  }
  NoteClock(sequence.verdict == SequenceVerdict::kNext, start_ns);
  skipped_steps_ = 0;
  heard_ns_ = datagram.arrival_ns;
  traffic_ = false;  // the next tick is counted from this pack on
  next_tick_ns_ = std::max(grid_.next_due_ns(), datagram.arrival_ns) + SilenceMargin(period_ns_);
  count.received.Add();

  if (DataPack* copy = record_ != nullptr ? record_->Claim() : nullptr; copy != nullptr) {
    codec_.CopyTo(copy);
    record_->Commit();
  }
  PackSlot* slot = ring_->Claim();
  if (slot == nullptr) {
    count.ring_full.Add();
    counters_->faults.Raise(estimator_status_t::FAULT_BACKLOG);
    return false;
  }
  codec_.CopyTo(&slot->pack);
  slot->times = {};
  slot->times.release_ns = point.release_ns;
  slot->times.lateness_ns = std::max(point.lateness_ns, point.unsettled_ns);
  slot->times.arrival_ns = datagram.arrival_ns;
  slot->times.deadline_ns = point.release_ns + deadline_ns_;
  slot->times.start_ns[IndexOf(Stage::kCollect)] = start_ns;
  if (injection_ != nullptr) injection_->Disturb(Stage::kCollect, codec_.seq());
  const Nanos end_ns = MonotonicNow();
  slot->times.end_ns[IndexOf(Stage::kCollect)] = end_ns;
  slot->times.withheld_before_ns[IndexOf(Stage::kCollect)] = cpu_time_.withheld_before_ns();
  slot->times.withheld_ns[IndexOf(Stage::kCollect)] = cpu_time_.End(end_ns);
  ring_->Commit();
  return true;
}

void CollectStage::Tick(Nanos now_ns) noexcept ARMCMC_NONBLOCKING {
  next_tick_ns_ = std::max(next_tick_ns_ + period_ns_, now_ns + period_ns_ / 2);
  if (traffic_) {
    traffic_ = false;  // bad or repeated packs: their faults are flagged, the plant is not silent
    return;
  }
  if (grid_.locked()) {
    counters_->collect.silent_periods.Add();
    ++silent_in_a_row_;
  }
  counters_->collect.silent.store(true, std::memory_order_relaxed);
  if (!silence_reported_ && now_ns - heard_ns_ >= kShortestReportedSilence) {
    silence_reported_ = true;
    events_->Add(
        {now_ns, grid_.locked() ? EventKind::kPlantSilent : EventKind::kWaitingForPlant, 0, tracker_.newest(), 0});
  }
}

}  // namespace armcmc::rt
