#include "budget.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <vector>

#include "armcmc/adjust_result.hpp"
#include "armcmc/estimator.hpp"

namespace armcmc::gap {
namespace {

constexpr int kMaxPacks = 10;

std::vector<DataPack> ReadPacks(const Estimator& estimator, const std::shared_ptr<const PlantProgram>& described,
                                replay::SourceRequest request) {
  request.plant = estimator.plant();
  request.num_inputs = estimator.num_inputs();
  request.described = described;
  for (int mode = 0; mode < estimator.num_modes(); ++mode) request.mode_names.emplace_back(estimator.mode_name(mode));
  const auto source = replay::OpenSource(request);
  std::vector<DataPack> packs;
  replay::RecordedPack next;
  while (static_cast<int>(packs.size()) < kMaxPacks && source->Next(&next)) packs.push_back(next.pack);
  return packs;
}

/// Runs one estimator and records the time of each step.
class Timed {
 public:
  explicit Timed(const EstimatorSettings& settings) : estimator_(settings), result_(estimator_.MakeResult()) {}
  void Step(const DataPack& pack) {
    const auto start = std::chrono::steady_clock::now();
    (void)estimator_.Adjust(pack, kNever, ClockRef(), result_.get());
    ms_.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    estimator_.Execute(*result_, &estimate_);
  }
  [[nodiscard]] double MedianMs() {
    const auto middle = ms_.begin() + static_cast<std::ptrdiff_t>(ms_.size() / 2);
    std::nth_element(ms_.begin(), middle, ms_.end());
    return *middle;
  }

 private:
  static constexpr Nanos kNever = std::numeric_limits<Nanos>::max();
  Estimator estimator_;
  std::unique_ptr<AdjustResult> result_;
  Estimate estimate_;
  std::vector<double> ms_;
};

}  // namespace

Budget MeasureBudget(const EstimatorSettings& base, const EstimatorSettings& augmented,
                     const replay::SourceRequest& packs) {
  Timed before(base), after(augmented);
  Budget budget;
  budget.deadline_ms = 1e3 * packs.period;
  // In turn, so that both run under the same conditions.
  for (const DataPack& pack : ReadPacks(Estimator(base), base.plant, packs)) {
    before.Step(pack);
    after.Step(pack);
    budget.measured = true;
  }
  if (!budget.measured) return budget;
  budget.adjust_ms_before = before.MedianMs();
  budget.adjust_ms_after = after.MedianMs();
  budget.meets_deadline = budget.adjust_ms_after < budget.deadline_ms;
  return budget;
}

}  // namespace armcmc::gap
