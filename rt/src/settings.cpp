#include "armcmc/rt/settings.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/lcm_url.hpp"

namespace armcmc::rt {
namespace {

std::string Millis(Nanos ns) {
  std::ostringstream out;
  out << static_cast<double>(ns) / static_cast<double>(kNanosPerMilli);
  return out.str();
}

void Require(bool ok, const std::string& key, const std::string& value, const std::string& expected) {
  if (!ok) throw std::invalid_argument(key + " = " + value + ": expected " + expected);
}

void ValidateThread(const char* name, const ThreadSettings& thread) {
  const std::string table = std::string("rt.") + name;
  Require(thread.priority >= 1 && thread.priority <= 99, table + ".priority", std::to_string(thread.priority),
          "a SCHED_FIFO priority in [1, 99]");
  Require(thread.cpu >= 0 && thread.cpu < 1024, table + ".cpu", std::to_string(thread.cpu),
          "a CPU number in [0, 1023]");
}

}  // namespace

Nanos RtSettings::ExecuteReserveNs() const noexcept {
  return std::min(deadline_ns - adjust_budget_ns, deadline_ns / 5);
}

void RtSettings::Validate() const {
  Require(period_ns >= kMinPeriodNs && period_ns <= kMaxPeriodNs, "timing.period_ms", Millis(period_ns),
          "[1, 10000] ms");
  Require(deadline_ns > 0 && deadline_ns <= kMaxDeadlinePeriods * period_ns, "timing.deadline_ms", Millis(deadline_ns),
          "more than 0 and at most " + Millis(kMaxDeadlinePeriods * period_ns) + " ms (ten periods)");
  Require(adjust_budget_ns > 0 && adjust_budget_ns <= period_ns && adjust_budget_ns < deadline_ns,
          "timing.adjust_budget_ms", Millis(adjust_budget_ns),
          "more than 0, at most the period (" + Millis(period_ns) + " ms) and less than the deadline (" +
              Millis(deadline_ns) + " ms)");
  ValidateThread("collect", collect);
  ValidateThread("adjust", adjust);
  ValidateThread("execute", execute);
  ValidateThread("publish", publish);
  const int lowest_stage = std::min({collect.priority, adjust.priority, execute.priority});
  const int highest_stage = std::max({collect.priority, adjust.priority, execute.priority});
  Require(publish.priority < lowest_stage, "rt.publish.priority", std::to_string(publish.priority),
          "less than the priority of every stage (" + std::to_string(lowest_stage) + ")");
  Require(witness_priority > highest_stage && witness_priority <= 99, "rt.witness.priority",
          std::to_string(witness_priority),
          "more than the priority of every stage (" + std::to_string(highest_stage) + ") and at most 99");
  (void)ParseLcmUrl(lcm_url);
  Require(prefix.size() <= kMaxPrefixLength, "lcm.prefix", "\"" + prefix + "\"",
          "at most " + std::to_string(kMaxPrefixLength) + " characters");
}

}  // namespace armcmc::rt
