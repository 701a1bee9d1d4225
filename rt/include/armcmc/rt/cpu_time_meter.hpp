#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc::rt {

/// CPU time that the calling thread has had, ns. Time that a hypervisor takes from the CPU is not in it, where the
/// hypervisor says so (steal time). @rt One system call, bounded.
[[nodiscard]] Nanos ThreadCpuTime() noexcept ARMCMC_NONBLOCKING;

/// How long the machine withheld the CPU from a stage while it worked.
///
/// A stage that works never waits: from its start to its end it wants its CPU. What it did not get of it,
///   withheld = (end - start) - its own CPU time - that of our other threads on this CPU,
/// was taken by a hypervisor, the kernel or a thread that is not ours. A witness only samples: of stalls that come in
/// slices it sees what is left of each at its next wake-up. This sees all of them, but only while the stage works.
///
/// Of a stage that went to sleep by itself, once, in that time, it says nothing: then waiting was its own doing. Used
/// by the thread of the stage; everything but SetTrusted() before that starts.
class CpuTimeMeter {
 public:
  static constexpr std::size_t kMaxOthers = 8;

  /// Another thread of ours on the CPU of this stage. @param cpu_time_ns  See RtThread::cpu_time_ns(); outlives this.
  void AddOther(const std::atomic<Nanos>* cpu_time_ns) noexcept;
  /// Whether the thread is pinned to its CPU, above everything ordinary: otherwise it merely waits for its turn, and
  /// nothing is ever withheld.
  void SetTrusted(bool trusted) noexcept { trusted_.store(trusted, std::memory_order_relaxed); }

  /// @return now, at which the work begins. @rt Two system calls, bounded.
  Nanos Start() noexcept ARMCMC_NONBLOCKING;
  /// @param end_ns  Now: the end of the work that began with Start(). @return ns >= 0. @rt Two system calls, bounded.
  [[nodiscard]] Nanos Withheld(Nanos end_ns) const noexcept ARMCMC_NONBLOCKING;

 private:
  /// @return CPU time of the thread and of the others.
  [[nodiscard]] Nanos Used() const noexcept ARMCMC_NONBLOCKING;

  std::array<const std::atomic<Nanos>*, kMaxOthers> others_{};
  std::size_t num_others_ = 0;
  std::atomic<bool> trusted_{false};
  Nanos start_ns_ = 0, used_at_start_ns_ = 0;
  std::int64_t sleeps_at_start_ = 0;
};

}  // namespace armcmc::rt
