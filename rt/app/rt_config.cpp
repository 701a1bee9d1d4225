#include "rt_config.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/lcm_url.hpp"

namespace armcmc::app {
namespace {

using support::StrictTable;

double ToMillis(Nanos ns) { return static_cast<double>(ns) / static_cast<double>(rt::kNanosPerMilli); }
Nanos ToNanos(double ms) { return std::llround(ms * static_cast<double>(rt::kNanosPerMilli)); }

void ReadTiming(StrictTable timing, rt::RtSettings* settings) {
  const double period = timing.Number("period_ms", ToMillis(settings->period_ns), 1.0, 10'000.0);
  const double deadline = timing.Number("deadline_ms", period, 0.01, rt::RtSettings::kMaxDeadlinePeriods * period);
  const double most = std::min(period, deadline);
  const double budget = timing.Number("adjust_budget_ms", 0.8 * most, 0.001, most);
  settings->period_ns = ToNanos(period);
  settings->deadline_ns = ToNanos(deadline);
  settings->adjust_budget_ns = ToNanos(budget);
  if (settings->adjust_budget_ns >= settings->deadline_ns) {
    throw timing.Error("adjust_budget_ms",
                       "must be less than deadline_ms, so that time is left to execute and publish");
  }
}

void ReadThread(StrictTable table, rt::ThreadSettings* thread) {
  thread->priority = static_cast<int>(table.Integer("priority", thread->priority, 1, 99));
  thread->cpu = static_cast<int>(table.Integer("cpu", thread->cpu, 0, 1023));
}

void ReadRt(StrictTable table, rt::RtSettings* settings) {
  const std::string mode = table.Choice("mode", "best_effort", {"best_effort", "enforce"});
  settings->mode = mode == "enforce" ? rt::RtMode::kEnforce : rt::RtMode::kBestEffort;
  settings->lock_memory = table.Boolean("lock_memory", settings->lock_memory);
  const std::string idle = table.Choice("cpu_idle", "auto", {"auto", "awake", "sleep"});
  settings->cpu_idle = idle == "awake"   ? rt::CpuIdle::kAwake
                       : idle == "sleep" ? rt::CpuIdle::kSleep
                                         : rt::CpuIdle::kAuto;
  ReadThread(table.Table("collect"), &settings->collect);
  ReadThread(table.Table("adjust"), &settings->adjust);
  ReadThread(table.Table("execute"), &settings->execute);
  ReadThread(table.Table("publish"), &settings->publish);
  // One witness on every CPU that a stage runs on: it has a priority and no CPU of its own.
  StrictTable witness = table.Table("witness");
  settings->witness_priority = static_cast<int>(witness.Integer("priority", settings->witness_priority, 1, 99));
  StrictTable watchdog = table.Table("watchdog");
  settings->on_hang =
      watchdog.Choice("on_hang", "degrade", {"degrade", "exit"}) == "exit" ? rt::OnHang::kExit : rt::OnHang::kDegrade;
}

void ReadLcm(StrictTable table, rt::RtSettings* settings) {
  settings->lcm_url = table.Text("url", settings->lcm_url);
  settings->prefix = table.Text("prefix", settings->prefix);
  try {
    (void)rt::ParseLcmUrl(settings->lcm_url);
  } catch (const std::invalid_argument& error) {
    throw table.Error("url", error.what());
  }
  if (settings->prefix.size() > rt::kMaxPrefixLength) {
    throw table.Error("prefix", "longer than " + std::to_string(rt::kMaxPrefixLength) + " characters");
  }
}

}  // namespace

rt::RtSettings ReadRtSettings(StrictTable& root) {
  rt::RtSettings settings;
  ReadTiming(root.Table("timing"), &settings);
  ReadRt(root.Table("rt"), &settings);
  ReadLcm(root.Table("lcm"), &settings);
  try {
    settings.Validate();
  } catch (const std::invalid_argument& error) {
    throw root.Error("rt", error.what());
  }
  return settings;
}

std::vector<rt::InjectionItem> ReadInjections(StrictTable& root) {
  if (!root.Has("inject")) return {};
  StrictTable table = root.Table("inject");
  const std::string plan = table.Text("plan", "");
  try {
    return rt::ParseInjections(plan);
  } catch (const std::invalid_argument& error) {
    throw table.Error("plan", error.what());
  }
}

GapLogSettings ReadGapLogSettings(StrictTable& root) {
  GapLogSettings settings;
  StrictTable table = root.Table("gap_log");
  settings.directory = table.Text("directory", settings.directory);
  settings.window_s = table.Number("window_s", settings.window_s, 1.0, 3600.0);
  settings.after_s = table.Number("after_s", settings.after_s, 0.0, 3600.0);
  settings.max_files = static_cast<int>(table.Integer("max_files", settings.max_files, 1, 10'000));
  return settings;
}

}  // namespace armcmc::app
