#pragma once

#include <cstdint>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/spsc_ring.hpp"
#include "armcmc/types.hpp"

namespace armcmc::rt {

/// Events for the operator, printed by a thread outside the real-time part. The meaning of the numbers a and b depends
/// on the kind.
enum class EventKind : std::uint8_t {
  kWaitingForPlant,  ///< No pack yet.
  kPlantFirstSeen,   ///< a: pack number.
  kPlantSilent,      ///< a: newest pack number.
  kPlantBack,        ///< a: pack number, b: silent periods.
  kPlantRestarted,   ///< a: pack number, b: run_id.
  kPackRejected,     ///< a: RejectCause.
  kPacksLost,        ///< a: how many, b: pack number after the gap.
  kDeadlineMissed,   ///< a: pack number, b: lacked, ns; `detail` is the MissCause.
  kPackDropped,      ///< a: pack number; `detail` is the MissCause.
  kNumericTrouble,   ///< a: pack number; `detail` is the Status of core.
  kPublishFailed,    ///< a: failures so far.
  kGapSuspected,     ///< a: pack since when; `detail` is the check, see Estimator::gap_check_name().
  kClockJumped,      ///< a: pack number, b: by how much, ns.
  kBusFlooded,       ///< a: messages of other channels in one period.
  kStageHung,        ///< a: ns overdue when it was seen; `detail` is the Watched.
  kInjected,         ///< a: pack number, b: amount; `detail` is the InjectionKind.
  kOverlapDiffers,   ///< a: samples from pack to pack, b: what PackFormat::overlap says. Once in a run of the plant.
};
/// Number of kinds.
inline constexpr int kNumEventKinds = 17;

/// One event, of fixed size, without text.
struct Event {
  Nanos t_ns = 0;  ///< CLOCK_MONOTONIC.
  EventKind kind = EventKind::kWaitingForPlant;
  std::uint8_t detail = 0;    ///< See EventKind; else 0.
  std::int64_t a = 0, b = 0;  ///< See EventKind; else 0.
};

/// Fixed ring of events from one thread to the one that prints. A full ring drops the event and counts it.
class EventLog {
 public:
  /// Adds an event; counts it as dropped if the ring is full. By the thread that owns the log. @rt Wait-free.
  void Add(const Event& event) noexcept ARMCMC_NONBLOCKING {
    Event* slot = ring_.Claim();
    if (slot == nullptr) {
      dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
      return;
    }
    *slot = event;
    ring_.Commit();
  }

  /// Takes the oldest event. By the thread that prints. @return false if there is none.
  [[nodiscard]] bool Take(Event* event) noexcept {
    const Event* front = ring_.Front();
    if (front == nullptr) return false;
    *event = *front;
    ring_.Pop();
    return true;
  }

  /// Number of dropped events. Any thread, any time.
  [[nodiscard]] std::int64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  SpscRing<Event, 256> ring_;
  std::atomic<std::int64_t> dropped_{0};
};

}  // namespace armcmc::rt
