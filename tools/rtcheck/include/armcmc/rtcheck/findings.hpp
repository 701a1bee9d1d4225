#pragma once

#include <string>
#include <vector>

#include "armcmc/rt/log_histogram.hpp"
#include "armcmc/rtcheck/system_root.hpp"

namespace armcmc::rtcheck {

enum class Level : unsigned char {
  kOk,
  kAdvice,  ///< Costs something; deadlines may hold all the same.
  kUnfit,   ///< The period or the deadline cannot be relied upon.
};

struct Finding {
  std::string name;  ///< One word.
  Level level = Level::kOk;
  std::string what;    ///< What is the case.
  std::string cost;    ///< What that costs; "" when nothing.
  std::string remedy;  ///< The exact command that fixes it; "" when nothing needs to be fixed.
};

/// What is to be relied upon.
struct Demand {
  double period_ms = 100.0;
  double deadline_ms = 100.0;
  int cpu = 1;  ///< That of the adjust stage.
};

/// Privileges of this process: real-time priority, locked memory, receive buffers.
[[nodiscard]] std::vector<Finding> CheckProcess(const SystemRoot& root);
/// Processors: number, isolation, interrupts, governor, idle states, siblings.
[[nodiscard]] std::vector<Finding> CheckCpu(const SystemRoot& root, const Demand& demand);
/// Kernel, throttling, timers, swap, hypervisor, bus.
[[nodiscard]] std::vector<Finding> CheckSystem(const SystemRoot& root);

/// How late a timer thread was woken.
struct WakeUps {
  rt::LogHistogram late_ns;
  bool fifo = false, pinned = false;
};
/// Measures for so many seconds, once a millisecond, on one CPU, as SCHED_FIFO when that is permitted.
[[nodiscard]] WakeUps MeasureWakeUps(int cpu, double seconds);
/// Judges them: a quarter of the deadline may be lost once in a thousand wake-ups, the whole of it never.
[[nodiscard]] Finding CheckWakeUps(const WakeUps& wake_ups, const Demand& demand);

[[nodiscard]] bool IsFit(const std::vector<Finding>& findings);
[[nodiscard]] std::string ReportText(const std::vector<Finding>& findings, const WakeUps* wake_ups,
                                     const Demand& demand);
[[nodiscard]] std::string ReportJson(const std::vector<Finding>& findings, const WakeUps* wake_ups,
                                     const Demand& demand);

}  // namespace armcmc::rtcheck
