#include <array>
#include <cstdio>
#include <sstream>

#include "armcmc/rtcheck/findings.hpp"

namespace armcmc::rtcheck {
namespace {

Finding Kernel(const SystemRoot& root) {
  const std::string version = root.Text("proc/version").value_or("");
  if (root.Number("sys/kernel/realtime").value_or(0) == 1 || version.find("PREEMPT_RT") != std::string::npos) {
    return {"kernel", Level::kOk, "PREEMPT_RT", "", ""};
  }
  return {"kernel", Level::kAdvice, "not PREEMPT_RT",
          "kernel sections that cannot be interrupted: occasionally 1 ms or more",
          "sudo apt-get install linux-image-rt-amd64   # then restart"};
}

Finding Throttling(const SystemRoot& root) {
  const long runtime = root.Number("proc/sys/kernel/sched_rt_runtime_us").value_or(-1);
  if (runtime < 0) return {"rt_throttling", Level::kOk, "off", "", ""};
  const long period = root.Number("proc/sys/kernel/sched_rt_period_us").value_or(1'000'000);
  return {"rt_throttling", Level::kAdvice,
          "real-time threads may run " + std::to_string(runtime) + " of " + std::to_string(period) + " us",
          "after that they are suspended for " + std::to_string((period - runtime) / 1000) + " ms",
          "echo kernel.sched_rt_runtime_us=-1 | sudo tee -a /etc/sysctl.d/60-armcmc.conf && sudo sysctl --system"};
}

Finding TimerMigration(const SystemRoot& root) {
  if (root.Number("proc/sys/kernel/timer_migration").value_or(0) == 0) {
    return {"timer_migration", Level::kOk, "off", "", ""};
  }
  return {"timer_migration", Level::kAdvice, "timers may move to another CPU", "a few us on some wake-ups",
          "echo kernel.timer_migration=0 | sudo tee -a /etc/sysctl.d/60-armcmc.conf && sudo sysctl --system"};
}

Finding Swap(const SystemRoot& root) {
  const std::string swaps = root.Text("proc/swaps").value_or("");
  if (swaps.find('\n') == std::string::npos) return {"swap", Level::kOk, "none", "", ""};
  return {"swap", Level::kAdvice, "swap is on", "what is not locked (the plant, the tools) may stall for 100 ms",
          "sudo swapoff -a   # and take it out of /etc/fstab"};
}

Finding Hypervisor(const SystemRoot& root) {
  std::istringstream line(root.Line("proc/stat", "cpu ").value_or(""));
  std::array<double, 8> t{};  // user nice system idle iowait irq softirq steal
  double sum = 0.0;
  for (double& field : t) {
    line >> field;
    sum += field;
  }
  const double steal = sum > 0.0 ? t[7] / sum : 0.0;
  const bool is_virtual = root.Text("proc/cpuinfo").value_or("").find(" hypervisor") != std::string::npos;
  if (!is_virtual && t[7] == 0.0) return {"hypervisor", Level::kOk, "none", "", ""};
  char what[96];
  std::snprintf(what, sizeof what, "a virtual machine; %.3g %% of the time since its start was stolen", 100.0 * steal);
  return {"hypervisor", Level::kAdvice, what, "the machine stalls for up to 100 ms, and no thread can see why",
          "run on a dedicated computer, or pin the virtual processors (virsh vcpupin) and lift their quota"};
}

Finding Route(const SystemRoot& root) {
  std::istringstream lines(root.Text("proc/net/route").value_or(""));
  std::string device, destination;
  std::getline(lines, device);  // the header
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    fields >> device >> destination;
    // Little endian: 224.0.0.0 is 000000E0, a host route to the group 434CFFEF, the default route 00000000.
    if (destination == "000000E0" || destination == "434CFFEF") {
      return {"multicast", Level::kOk, "multicast is routed over " + device, "", ""};
    }
    if (destination == "00000000")
      return {"multicast", Level::kOk, "multicast uses the default route, over " + device, "", ""};
  }
  return {"multicast", Level::kUnfit, "no route for multicast", "LCM does not start",
          "sudo ip link set lo up && sudo ip route add 224.0.0.0/4 dev lo"};
}

Finding ClockSource(const SystemRoot& root) {
  const std::string source =
      root.Text("sys/devices/system/clocksource/clocksource0/current_clocksource").value_or("unknown");
  if (source != "hpet" && source != "acpi_pm" && source != "jiffies") return {"clock", Level::kOk, source, "", ""};
  return {"clock", Level::kAdvice, "clock source " + source, "every reading of the clock is slow: 1 us or more",
          "echo tsc | sudo tee /sys/devices/system/clocksource/clocksource0/current_clocksource"};
}

}  // namespace

std::vector<Finding> CheckSystem(const SystemRoot& root) {
  return {Kernel(root),     Throttling(root), TimerMigration(root), Swap(root),
          Hypervisor(root), Route(root),      ClockSource(root)};
}

}  // namespace armcmc::rtcheck
