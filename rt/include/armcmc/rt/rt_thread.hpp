#pragma once

#include <pthread.h>

#include <atomic>
#include <cstddef>
#include <limits>
#include <string>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/settings.hpp"
#include "armcmc/rt/waiter.hpp"
#include "armcmc/types.hpp"

namespace armcmc::rt {

/// Requested properties of a thread.
struct ThreadRequest {
  const char* name = "";                ///< At most 15 characters; shown by ps and top.
  int priority = 0;                     ///< SCHED_FIFO.
  int cpu = -1;                         ///< Pinned there; -1 leaves the affinity alone.
  std::size_t stack_bytes = 2U << 20U;  ///< Size of the stack, which is touched before the thread starts to work.
};

/// Actual properties, read back from the kernel inside the thread.
struct ThreadPlacement {
  std::string name;     ///< As requested.
  bool fifo = false;    ///< SCHED_FIFO at the requested priority.
  bool pinned = false;  ///< On exactly the requested CPU.
  int priority = 0;     ///< 0 under SCHED_OTHER.
  int cpu = -1;         ///< -1 when not pinned to one CPU.
};

/// A pinned SCHED_FIFO thread with a small, prefaulted stack. Start() and Join() are for the thread that owns it.
class RtThread {
 public:
  /// Function of the thread; its return ends the thread.
  using Entry = void (*)(void* context) noexcept;
  /// No limit for NoteCpuTime().
  static constexpr Nanos kNoLimit = std::numeric_limits<Nanos>::max();
  static constexpr Nanos kShortTurnNs = 100'000;  ///< Run time of a thread that only reads the clock and a few numbers.

  RtThread() = default;
  ~RtThread() { Join(); }
  RtThread(const RtThread&) = delete;
  RtThread& operator=(const RtThread&) = delete;

  /// Creates the thread and waits until it has touched its stack and read its policy and affinity back.
  /// Signals are those of the caller. Without the privileges: throws in kEnforce, else runs without them.
  /// @param request  Priority 0 asks for SCHED_OTHER, CPU -1 for no affinity.
  /// @param mode     What to do without the privileges.
  /// @param entry    Must return when its owner tells it to, see Join(). @param context  Its argument.
  /// @throws PrivilegeError (kEnforce), std::runtime_error when no thread can be made at all.
  const ThreadPlacement& Start(const ThreadRequest& request, RtMode mode, Entry entry, void* context);
  /// Waits until the entry function has returned. Without a thread, nothing.
  void Join() noexcept;
  /// Placement as read back by Start().
  [[nodiscard]] const ThreadPlacement& placement() const noexcept { return placement_; }

  /// Says how much CPU time the thread has had, for cpu_time_ns(). By the thread itself, before it waits.
  /// @param most_ns  Upper bound of what the thread can have used since the last call; the excess is not counted. The
  ///                 kernel charges a stall that the hypervisor does not report to the thread that ran when it began.
  /// @rt One system call, bounded.
  void NoteCpuTime(Nanos most_ns = kNoLimit) noexcept ARMCMC_NONBLOCKING;
  /// CPU time, ns, of the thread up to its newest wait. Any time, from any thread.
  [[nodiscard]] const std::atomic<Nanos>& cpu_time_ns() const noexcept { return cpu_time_ns_; }

 private:
  /// What pthread_create() runs: touches the stack, reads back, waits for Start() to agree, calls the entry.
  static void* Main(void* self);
  /// @return 0, or the error of pthread_create() and its attributes.
  [[nodiscard]] int Create(bool fifo, bool pin) noexcept;
  void ReadBack();

  ThreadRequest request_;  ///< As given to Start().
  ThreadPlacement placement_;
  Entry entry_ = nullptr;
  void* context_ = nullptr;  ///< Argument of entry_.
  Waiter ready_;             // thread -> Start(): placement_ is known
  Waiter go_;                // Start() -> thread
  bool refused_ = false;     // written before go_
  pthread_t thread_{};
  bool running_ = false;
  std::atomic<Nanos> cpu_time_ns_{0};
  Nanos charged_ns_ = 0;  // by the kernel, at the last note
};

}  // namespace armcmc::rt
