#include <algorithm>
#include <filesystem>

#include "armcmc/rt/settings.hpp"
#include "armcmc/rtcheck/findings.hpp"

namespace armcmc::rtcheck {
namespace {

constexpr char kCpus[] = "sys/devices/system/cpu/";

std::string CpuFolder(int cpu) { return kCpus + ("cpu" + std::to_string(cpu)) + "/"; }

Finding Number(const SystemRoot& root) {
  const auto cpus = ParseCpuList(root.Text(std::string(kCpus) + "online").value_or("0"));
  if (cpus.size() >= 2) return {"cpus", Level::kOk, std::to_string(cpus.size()) + " processors", "", ""};
  return {"cpus", Level::kUnfit, "one processor", "collect delays adjust, and so does everything else",
          "use a computer with at least two, or give the virtual machine two"};
}

Finding Isolation(const SystemRoot& root, int cpu) {
  const bool isolated = ParseCpuList(root.Text(std::string(kCpus) + "isolated").value_or("")).contains(cpu);
  const bool tickless = ParseCpuList(root.Text(std::string(kCpus) + "nohz_full").value_or("")).contains(cpu);
  const std::string name = "CPU " + std::to_string(cpu);
  if (isolated && tickless) return {"isolation", Level::kOk, name + " is isolated, without a timer tick", "", ""};
  const std::string n = std::to_string(cpu);
  return {"isolation", Level::kAdvice,
          name + (isolated ? " is isolated, but has a timer tick" : " is shared with all other processes"),
          "kernel threads and timers of other programs: tens of us, occasionally ms",
          "sudo sed -i 's/^GRUB_CMDLINE_LINUX=\"/&isolcpus=managed_irq,domain," + n + " nohz_full=" + n +
              " rcu_nocbs=" + n + " /' /etc/default/grub && sudo update-grub   # then restart"};
}

Finding Interrupts(const SystemRoot& root, int cpu) {
  const auto text = root.Text("proc/irq/default_smp_affinity");
  if (!text) return {"irq_affinity", Level::kOk, "not reported by this kernel", "", ""};
  std::string digits = *text;
  std::erase(digits, ',');
  const auto place = static_cast<std::size_t>(cpu / 4);
  const char digit = place < digits.size() ? digits[digits.size() - 1 - place] : '0';
  const int value = digit <= '9' ? digit - '0' : (digit | 0x20) - 'a' + 10;
  if ((value >> (cpu % 4) & 1) == 0) return {"irq_affinity", Level::kOk, "interrupts go to other CPUs", "", ""};
  return {"irq_affinity", Level::kAdvice, "new interrupts may go to CPU " + std::to_string(cpu), "5 to 50 us each",
          "echo 1 | sudo tee /proc/irq/default_smp_affinity; sudo systemctl disable --now irqbalance"};
}

Finding Governor(const SystemRoot& root, int cpu) {
  const auto governor = root.Text(CpuFolder(cpu) + "cpufreq/scaling_governor");
  if (!governor)
    return {"governor", Level::kOk, "no frequency scaling (or a virtual machine, which does not show it)", "", ""};
  if (*governor == "performance") return {"governor", Level::kOk, "governor performance", "", ""};
  return {"governor", Level::kAdvice, "governor " + *governor,
          "the clock rate rises only after load begins: a step takes up to three times as long",
          "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor"};
}

Finding IdleStates(const SystemRoot& root, const Demand& demand) {
  long worst_us = 0;
  for (int state = 0; state < 16; ++state) {
    const std::string folder = CpuFolder(demand.cpu) + "cpuidle/state" + std::to_string(state) + "/";
    if (root.Number(folder + "disable").value_or(0) != 0) continue;
    worst_us = std::max(worst_us, root.Number(folder + "latency").value_or(0));
  }
  const std::string what = "leaving the deepest idle state takes " + std::to_string(worst_us) + " us";
  const bool matters = static_cast<double>(worst_us) > 0.01 * 1000.0 * demand.deadline_ms;
  if (!matters) return {"idle_states", Level::kOk, what, "", ""};
  return {"idle_states", Level::kAdvice, what, "this long at the start of every step",
          "sudo cpupower idle-set -D 10   # or processor.max_cstate=1 intel_idle.max_cstate=1 on the kernel's line"};
}

Finding WakeRequest(const SystemRoot& root, const Demand& demand) {
  constexpr double kAwakeBelowMs = static_cast<double>(rt::RtSettings::kAwakeBelowNs) * 1e-6;
  if (demand.period_ms >= kAwakeBelowMs) return {"cpu_idle", Level::kOk, "idle CPUs may sleep at this period", "", ""};
  if (root.MayWrite("dev/cpu_dma_latency"))
    return {"cpu_idle", Level::kOk, "the estimator may keep idle CPUs awake", "", ""};
  return {"cpu_idle", Level::kAdvice, "this user may not keep idle CPUs awake",
          "0.05 to 0.1 ms at each of the three wake-ups of a step",
          "sudo install /usr/share/armcmc/deploy/60-armcmc.rules /etc/udev/rules.d/ && sudo udevadm trigger"};
}

Finding Siblings(const SystemRoot& root, int cpu) {
  auto siblings = ParseCpuList(root.Text(CpuFolder(cpu) + "topology/thread_siblings_list").value_or(""));
  siblings.erase(cpu);
  if (siblings.empty() || root.Number(std::string(kCpus) + "smt/active").value_or(1) == 0) {
    return {"smt", Level::kOk, "CPU " + std::to_string(cpu) + " has its core to itself", "", ""};
  }
  const std::string sibling = std::to_string(*siblings.begin());
  return {"smt", Level::kAdvice, "CPU " + std::to_string(cpu) + " shares its core with CPU " + sibling,
          "what runs there takes up to half of the adjust stage's speed",
          "echo 0 | sudo tee /sys/devices/system/cpu/cpu" + sibling + "/online"};
}

}  // namespace

std::vector<Finding> CheckCpu(const SystemRoot& root, const Demand& demand) {
  return {Number(root),
          Isolation(root, demand.cpu),
          Interrupts(root, demand.cpu),
          Governor(root, demand.cpu),
          IdleStates(root, demand),
          WakeRequest(root, demand),
          Siblings(root, demand.cpu)};
}

}  // namespace armcmc::rtcheck
