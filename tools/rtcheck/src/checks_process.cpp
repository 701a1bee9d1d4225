#include <charconv>
#include <cstdint>
#include <sstream>

#include "armcmc/rtcheck/findings.hpp"

namespace armcmc::rtcheck {
namespace {

constexpr unsigned kCapNetAdmin = 12, kCapIpcLock = 14, kCapSysNice = 23;

bool HasCapability(const SystemRoot& root, unsigned bit) {
  const auto text = root.Line("proc/self/status", "CapEff:");
  if (!text) return false;
  std::uint64_t mask = 0;
  std::from_chars(text->data(), text->data() + text->size(), mask, 16);
  return ((mask >> bit) & 1U) != 0;
}

/// Soft limit; "unlimited" is the greatest number.
long Limit(const SystemRoot& root, const char* name) {
  std::istringstream fields(root.Line("proc/self/limits", name).value_or("0"));
  std::string soft;
  fields >> soft;
  if (soft == "unlimited") return INT64_MAX;
  long value = 0;
  std::from_chars(soft.data(), soft.data() + soft.size(), value);
  return value;
}

}  // namespace

std::vector<Finding> CheckProcess(const SystemRoot& root) {
  std::vector<Finding> findings;
  constexpr long kPriority = 90, kLocked = 256L << 20U;
  const bool nice = HasCapability(root, kCapSysNice);
  const long priority = Limit(root, "Max realtime priority");
  Finding rtprio{"rtprio", Level::kOk, "SCHED_FIFO is permitted", "", ""};
  if (!nice && priority < kPriority) {
    rtprio = {"rtprio", Level::kUnfit,
              "real-time priorities up to " + std::to_string(priority) + " only, 90 are needed",
              "any other process delays every stage, by tens of ms under load",
              "echo '@realtime - rtprio 99' | sudo tee -a /etc/security/limits.d/armcmc.conf && sudo groupadd -f "
              "realtime && sudo usermod -aG realtime $USER   # then log in again"};
  }
  findings.push_back(rtprio);
  Finding memlock{"memlock", Level::kOk, "memory can be locked", "", ""};
  if (!HasCapability(root, kCapIpcLock) && Limit(root, "Max locked memory") < kLocked) {
    memlock = {"memlock", Level::kUnfit,
               "only " + std::to_string(Limit(root, "Max locked memory") / 1024) + " kB may be locked",
               "a page fault in a stage costs 1 us to 100 ms",
               "echo '@realtime - memlock unlimited' | sudo tee -a /etc/security/limits.d/armcmc.conf   # then log in "
               "again"};
  }
  findings.push_back(memlock);
  constexpr long kBuffer = 4'194'304;
  const long rmem = root.Number("proc/sys/net/core/rmem_max").value_or(0);
  Finding buffer{"socket_buffer", Level::kOk, "receive buffers of 4 MB are granted", "", ""};
  if (!HasCapability(root, kCapNetAdmin) && rmem < kBuffer) {
    buffer = {"socket_buffer", Level::kAdvice, "receive buffers are cut to " + std::to_string(rmem) + " bytes",
              "at 1 kHz a stall of 23 ms loses packs",
              "echo net.core.rmem_max=4194304 | sudo tee /etc/sysctl.d/60-armcmc.conf && sudo sysctl --system"};
  }
  findings.push_back(buffer);
  return findings;
}

}  // namespace armcmc::rtcheck
