#include "armcmc/stress/fault_catalog.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace armcmc::stress {
namespace {

using S = estimator_status_t;
using E = Evidence;

bool RejectedValue(const E& e) { return e.Rises(&S::rejected_value) && e.Flag(S::FAULT_BAD_DATA); }
bool RejectedSize(const E& e) { return e.Rises(&S::rejected_size) && e.Flag(S::FAULT_BAD_DATA); }
bool RejectedType(const E& e) { return e.Rises(&S::rejected_type) && e.Flag(S::FAULT_BAD_DATA); }
bool Rejected(const E& e) { return e.Rises(&S::packs_rejected) && e.Flag(S::FAULT_BAD_DATA); }
bool Hung(const E& e) { return e.Flag(S::FAULT_STAGE_HUNG); }
bool Missed(const E& e) { return e.Misses(); }

constexpr auto kPlant = FaultSource::kPlantPlan;
constexpr auto kOwn = FaultSource::kEstimatorPlan;
constexpr auto kSignal = FaultSource::kSignal;
constexpr auto kEnd = FaultSource::kPlantEnd;

constexpr const char* kByValue = "rejected_value, FAULT_BAD_DATA";
constexpr const char* kByMiss = "missed_own or packs_dropped";
constexpr const char* kByWatchdog = "the watchdog: FAULT_STAGE_HUNG";

const std::vector<FaultSpec> kCatalog = {
    {"nan", kPlant, "nan", 0, 0, 0, false, false, kByValue, RejectedValue},
    {"all_zero", kPlant, "zero", 0, 0, 0, false, false, kByValue, RejectedValue},
    {"huge", kPlant, "huge", 0, 0, 0, false, false, kByValue, RejectedValue},
    {"wrong_size", kPlant, "size", 0, 0, 0, false, false, "rejected_size, FAULT_BAD_DATA", RejectedSize},
    {"corrupt", kPlant, "corrupt", 0, 0, 0, false, false, "packs_rejected, FAULT_BAD_DATA", Rejected},
    {"garbage", kPlant, "garbage", 0, 0, 0, false, false, "packs_rejected, FAULT_BAD_DATA", Rejected},
    {"foreign_type", kPlant, "foreign", 0, 0, 0, false, false, "rejected_type, FAULT_BAD_DATA", RejectedType},
    {"duplicate", kPlant, "duplicate", 0, 0, 0, false, false, "packs_duplicate",
     [](const E& e) { return e.Rises(&S::packs_duplicate); }},
    {"reordered", kPlant, "reorder", 1, 0, 0, false, false, "packs_reordered",
     [](const E& e) { return e.Rises(&S::packs_reordered); }},
    {"lost", kPlant, "drop", 0, 0, 0, false, false, "packs_lost", [](const E& e) { return e.Rises(&S::packs_lost); }},
    {"late", kPlant, "late", 1.5, 0, 0, true, false, "missed_late_data or silent_periods",
     [](const E& e) { return e.Rises(&S::missed_late_data) || e.Rises(&S::silent_periods); }},
    {"clock_jump", kPlant, "clock", 5, 5000, 0, false, false, "FAULT_CLOCK_JUMP",
     [](const E& e) { return e.Flag(S::FAULT_CLOCK_JUMP); }},
    {"overrun_collect", kOwn, "overrun_collect", 1.5, 2, 0, true, false, kByMiss, Missed},
    {"overrun_adjust", kOwn, "overrun_adjust", 1.5, 2, 0, true, false, kByMiss, Missed},
    {"overrun_execute", kOwn, "overrun_execute", 1.5, 2, 0, true, false, kByMiss, Missed},
    {"hang_collect", kOwn, "hang_collect", 3, 40, 0, true, false, kByWatchdog, Hung},
    {"hang_adjust", kOwn, "hang_adjust", 3, 40, 0, true, false, kByWatchdog, Hung},
    {"hang_execute", kOwn, "hang_execute", 3, 40, 0, true, false, kByWatchdog, Hung},
    {"overload", kOwn, "squeeze", 0, 0, 0, false, false, "truncated_steps, FAULT_TRUNCATED, published on time",
     [](const E& e) { return e.Rises(&S::truncated_steps) && e.Flag(S::FAULT_TRUNCATED); }},
    {"collapse", kOwn, "collapse", 0, 0, 0, true, true, "mismatch above its threshold: DECISION_MODIFICATION",
     [](const E& e) { return e.modification; }},
    {"publish_failure", kOwn, "publish", 1, 0, 3, false, false, "publish_errors, FAULT_PUBLISH",
     [](const E& e) { return e.Rises(&S::publish_errors) && e.Flag(S::FAULT_PUBLISH); }},
    {"plant_stop", kSignal, "", 10, 1000, 0, true, false, "silent_periods, FAULT_PLANT_SILENT",
     [](const E& e) { return e.Rises(&S::silent_periods) && e.Flag(S::FAULT_PLANT_SILENT); }},
    {"estimator_stop", kSignal, "", 10, 1000, 0, true, false, "missed deadlines, packs_dropped", Missed},
    {"bus_flood", kSignal, "", 10, 1000, 0, false, false, "FAULT_BUS_FLOOD",
     [](const E& e) { return e.Flag(S::FAULT_BUS_FLOOD); }},
    {"log_disk_full", kEnd, "", 0, 0, 0, true, false, "the plant's message and exit code",
     [](const E& e) { return e.log_failure_reported; }},
    {"plant_death", kEnd, "", 0, 0, 0, true, false, "plant_restarts, FAULT_PLANT_SILENT",
     [](const E& e) { return e.Rises(&S::plant_restarts); }},
};

}  // namespace

bool Evidence::Misses() const {
  return Rises(&S::missed_own) || Rises(&S::missed_machine) || Rises(&S::missed_late_data) || Rises(&S::packs_dropped);
}

double FaultSpec::LastsMs(double period_ms) const { return std::ceil(std::max(periods * period_ms, milliseconds)); }

std::int64_t FaultSpec::LastsPacks(double period_ms) const {
  if (source != FaultSource::kPlantPlan && source != FaultSource::kEstimatorPlan) return 0;
  if (std::string(item) == "clock" || periods == 0.0) return 1;
  if (count > 0 || std::string(item) == "reorder") return 2;
  return static_cast<std::int64_t>(std::ceil(LastsMs(period_ms) / period_ms)) + 1;
}

std::string FaultSpec::PlanItem(std::int64_t pack, double period_ms) const {
  std::string text = std::string(item) + "@" + std::to_string(pack);
  const bool has_amount = count > 0 || (periods > 0.0 && std::string(item) != "reorder");
  if (!has_amount) return text;
  const auto amount = count > 0 ? count : std::lround(LastsMs(period_ms));
  return text + ":" + std::to_string(amount);
}

const std::vector<FaultSpec>& FaultCatalog() { return kCatalog; }

std::vector<const FaultSpec*> SelectFaults(const std::string& list) {
  std::vector<const FaultSpec*> chosen;
  if (list == "none") return chosen;
  if (list.empty() || list == "all") {
    for (const FaultSpec& fault : kCatalog) chosen.push_back(&fault);
    return chosen;
  }
  std::istringstream names(list);
  for (std::string name; std::getline(names, name, ',');) {
    const auto found = std::find_if(kCatalog.begin(), kCatalog.end(), [&](const auto& f) { return f.name == name; });
    if (found != kCatalog.end()) {
      chosen.push_back(&*found);
      continue;
    }
    std::string all;
    for (const FaultSpec& fault : kCatalog) all += std::string(all.empty() ? "" : ", ") + fault.name;
    throw std::invalid_argument("--inject " + name + ": no such fault; there are all, none, " + all);
  }
  return chosen;
}

std::string FlagNames(std::int32_t flags) {
  static constexpr std::pair<std::int32_t, const char*> kNames[] = {
      {S::FAULT_PLANT_SILENT, "plant_silent"}, {S::FAULT_PLANT_RESTARTED, "plant_restarted"},
      {S::FAULT_BAD_DATA, "bad_data"},         {S::FAULT_TRUNCATED, "truncated"},
      {S::FAULT_PUBLISH, "publish"},           {S::FAULT_BACKLOG, "backlog"},
      {S::FAULT_NUMERIC, "numeric"},           {S::FAULT_CLOCK_JUMP, "clock_jump"},
      {S::FAULT_BUS_FLOOD, "bus_flood"},       {S::FAULT_STAGE_HUNG, "stage_hung"}};
  std::string text;
  for (const auto& [bit, name] : kNames)
    if ((flags & bit) != 0) text += std::string(text.empty() ? "" : "|") + name;
  return text;
}

}  // namespace armcmc::stress
