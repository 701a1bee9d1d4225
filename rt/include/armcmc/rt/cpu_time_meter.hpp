#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc::rt {

/// CPU time that the calling thread has used, ns, without the time that a hypervisor takes from the CPU, if the
/// hypervisor reports it (steal time). @rt One system call, bounded.
[[nodiscard]] Nanos ThreadCpuTime() noexcept ARMCMC_NONBLOCKING;

/// How long the machine withheld the CPU from a stage that had work.
///
/// A stage needs its CPU from the moment it is given work until that work is done; it never waits in between. The time
/// that it did not get,
///
///     withheld = time - its own CPU time - CPU time of the other threads of this process on this CPU,
///
/// was taken by a hypervisor, the kernel or another process. A witness only samples: of stalls in short slices it sees
/// what remains of each at its next wake-up. This meter sees all of them, but only while the stage has work.
///
/// It never overestimates. Before the work begins only a stage with a higher priority can delay it for long: the CPU
/// time that this thread and those stages have used since the previous work is subtracted, and 0.1 ms for an ordinary
/// wake-up and the short turns of witness and watchdog. If the thread once slept during its work, nothing is reported,
/// because that wait was its own doing. Used by the thread of the stage; all but SetTrusted() before that starts.
class CpuTimeMeter {
 public:
  static constexpr std::size_t kMaxOthers = 8;

  /// Another thread of this process on the CPU of this stage. @param cpu_time_ns  See RtThread::cpu_time_ns(); outlives
  /// this.
  /// @param goes_first  It is a stage of this or a higher priority.
  void AddOther(const std::atomic<Nanos>* cpu_time_ns, bool goes_first) noexcept;
  /// Whether the thread is pinned to its CPU, above everything ordinary: otherwise it merely waits for its turn, and
  /// nothing is ever withheld.
  void SetTrusted(bool trusted) noexcept { trusted_.store(trusted, std::memory_order_relaxed); }

  /// The thread was notified of work at woken_ns. 0: it was not, but checked on its own.
  void NoteWoken(Nanos woken_ns) noexcept ARMCMC_NONBLOCKING { woken_ns_ = woken_ns; }
  /// @return now, at which the work begins. @rt Two system calls, bounded.
  Nanos Start() noexcept ARMCMC_NONBLOCKING;
  /// Withheld from when there was work until Start(), ns >= 0.
  [[nodiscard]] Nanos withheld_before_ns() const noexcept { return withheld_before_ns_; }
  /// Withheld from when there was work until now, instead of Start(): the work is not done. @rt A system call, bounded.
  [[nodiscard]] Nanos WithheldWaiting(Nanos now_ns) const noexcept ARMCMC_NONBLOCKING;
  /// @param end_ns  Now: the end of the work that began with Start().
  /// @return withheld in between, ns >= 0. @rt Two system calls, bounded.
  [[nodiscard]] Nanos End(Nanos end_ns) noexcept ARMCMC_NONBLOCKING;
  /// The work went on after its End(), to end_ns: now. @return withheld in between, ns >= 0. @rt As End().
  [[nodiscard]] Nanos Continue(Nanos end_ns) noexcept ARMCMC_NONBLOCKING;

 private:
  /// CPU times up to a moment.
  struct Use {
    Nanos all_ns = 0;    ///< Used by this thread and all others.
    Nanos first_ns = 0;  ///< Used by this thread and those that go first.
  };
  [[nodiscard]] Use Used() const noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] Nanos WithheldWaiting(Nanos now_ns, const Use& used) const noexcept ARMCMC_NONBLOCKING;
  /// From begin_ns, when `at_begin` had been used, to end_ns: now, which ends the work.
  [[nodiscard]] Nanos Withheld(Nanos begin_ns, const Use& at_begin, Nanos end_ns) noexcept ARMCMC_NONBLOCKING;

  struct Other {
    const std::atomic<Nanos>* cpu_time_ns = nullptr;
    bool goes_first = false;
  };
  std::array<Other, kMaxOthers> others_{};
  std::size_t num_others_ = 0;
  std::atomic<bool> trusted_{false};
  Nanos woken_ns_ = 0, withheld_before_ns_ = 0;
  Nanos start_ns_ = 0;
  Nanos end_ns_ = 0;  // of the work before
  Use used_at_start_, used_at_end_;
  std::int64_t sleeps_at_start_ = 0;
};

}  // namespace armcmc::rt
