#include "armcmc/stress/fault_layout.hpp"

#include <algorithm>
#include <cmath>

namespace armcmc::stress {
namespace {

constexpr std::int64_t kStepsToRecover = 6;  // one more than a fault may take, so that a slow recovery shows
constexpr double kShortestRecoveryMs = 150.0;
constexpr double kSignalMarginMs = 300.0;  // from the decision to send a signal to its effect on the bus

std::int64_t SlotPacks(const FaultSpec& fault, double period_ms) {
  const auto in_packs = [period_ms](double ms) { return static_cast<std::int64_t>(std::ceil(ms / period_ms)); };
  std::int64_t covered = fault.LastsPacks(period_ms);
  if (fault.source == FaultSource::kSignal) covered = in_packs(fault.LastsMs(period_ms) + kSignalMarginMs);
  return Slot::kQuietBefore + covered + std::max(kStepsToRecover, in_packs(kShortestRecoveryMs));
}

void Append(std::string* plan, const std::string& item) {
  if (!plan->empty()) *plan += ',';
  *plan += item;
}

}  // namespace

std::int64_t LearningPacks(double period_ms) {
  return std::max<std::int64_t>(15, static_cast<std::int64_t>(std::ceil(1500.0 / period_ms)));
}

FaultLayout LayOut(const std::vector<const FaultSpec*>& faults, std::size_t first, double period_ms,
                   std::int64_t packs) {
  FaultLayout layout;
  std::vector<const FaultSpec*> in_slots;
  std::copy_if(faults.begin(), faults.end(), std::back_inserter(in_slots),
               [](const FaultSpec* fault) { return fault->source != FaultSource::kPlantEnd; });
  std::int64_t begin = LearningPacks(period_ms);
  for (std::size_t i = 0; i < in_slots.size(); ++i) {
    const FaultSpec* fault = in_slots[(first + i) % in_slots.size()];
    const Slot slot{fault, begin, begin + SlotPacks(*fault, period_ms)};
    if (slot.end > packs) break;
    layout.slots.push_back(slot);
    if (fault->source == FaultSource::kPlantPlan) Append(&layout.plant_plan, fault->PlanItem(slot.at(), period_ms));
    if (fault->source == FaultSource::kEstimatorPlan) {
      Append(&layout.estimator_plan, fault->PlanItem(slot.at(), period_ms));
    }
    begin = slot.end;
  }
  layout.last_pack = begin;
  return layout;
}

}  // namespace armcmc::stress
