#pragma once

#include <cstdint>
#include <string>

#include "armcmc/types.hpp"

namespace armcmc::rt {

/// What to do when the machine does not grant real-time privileges.
enum class RtMode : std::uint8_t {
  kBestEffort,  ///< Run without them, warn once, and say so in every status message.
  kEnforce,     ///< Refuse to start and say what to do.
};

/// What to do when a stage hangs.
enum class OnHang : std::uint8_t {
  kDegrade,  ///< Go on with what still runs, and say so in every status message.
  kExit,     ///< End the process with an error, so that a supervisor starts a new one.
};

/// What a CPU does while it has nothing to do.
enum class CpuIdle : std::uint8_t {
  kAuto,   ///< kAwake when the period is shorter than RtSettings::kAwakeBelowNs, else kSleep.
  kAwake,  ///< It waits in a loop: quick to wake up, at the price of power. See CpuWakeRequest.
  kSleep,  ///< What the kernel likes.
};

/// Priority and CPU of one thread.
struct ThreadSettings {
  int priority = 0;  ///< SCHED_FIFO priority in [1, 99].
  int cpu = 0;       ///< CPU that the thread is pinned to, >= 0.
  bool operator==(const ThreadSettings&) const = default;
};

/// Everything that decides when and where the estimator computes (not what: that is EstimatorSettings).
struct RtSettings {
  static constexpr Nanos kMinPeriodNs = 1'000'000;
  static constexpr Nanos kMaxPeriodNs = 10'000'000'000;
  static constexpr int kMaxDeadlinePeriods = 10;
  /// Three wake-ups of 0.05 to 0.1 ms each are nothing in 10 ms, and a third of 1 ms.
  static constexpr Nanos kAwakeBelowNs = 10'000'000;

  Nanos period_ns = 100'000'000;        ///< T_s, time between packs, in [1 ms, 10 s].
  Nanos deadline_ns = 100'000'000;      ///< From the release of a step to the end of execute, in (0, 10 T_s].
  Nanos adjust_budget_ns = 80'000'000;  ///< Compute time of adjust; it stops before. <= period, < deadline.

  RtMode mode = RtMode::kBestEffort;
  bool lock_memory = true;  ///< mlockall(): a page fault is an unbounded delay.
  CpuIdle cpu_idle = CpuIdle::kAuto;
  ThreadSettings collect{80, 0};
  ThreadSettings adjust{70, 1};
  ThreadSettings execute{75, 0};
  ThreadSettings publish{40, 0};  ///< Below every stage.
  int witness_priority = 90;      ///< Above every stage: what delays the witness is not ours.
  OnHang on_hang = OnHang::kDegrade;

  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  std::string prefix;  ///< Put before every channel name, so that many plants share one bus.
  bool operator==(const RtSettings&) const = default;

  /// Time that adjust leaves to execute when a pack came late: a fifth of the deadline, or what is left of it.
  [[nodiscard]] Nanos ExecuteReserveNs() const noexcept;

  /// Whether the CPUs are to be kept awake.
  [[nodiscard]] bool KeepsCpusAwake() const noexcept {
    return cpu_idle == CpuIdle::kAwake || (cpu_idle == CpuIdle::kAuto && period_ns < kAwakeBelowNs);
  }

  /// @throws std::invalid_argument naming the key, its value and the allowed range.
  void Validate() const;
};

}  // namespace armcmc::rt
