#include "armcmc/adjust_result.hpp"
#include "armcmc/rt/step_engine.hpp"

namespace armcmc::rt {

EstimatorEngine::EstimatorEngine(const EstimatorSettings& settings) : estimator_(settings) {
  for (auto& result : results_) result = estimator_.MakeResult();
}

EstimatorEngine::~EstimatorEngine() = default;

PlantKind EstimatorEngine::plant() const noexcept { return estimator_.plant(); }
int EstimatorEngine::num_inputs() const noexcept { return estimator_.num_inputs(); }
int EstimatorEngine::num_modes() const noexcept { return estimator_.num_modes(); }
int EstimatorEngine::num_reported() const noexcept { return estimator_.num_reported(); }
ReportedQuantity EstimatorEngine::reported(int index) const noexcept { return estimator_.reported(index); }

Status EstimatorEngine::Adjust(const DataPack& pack, Nanos deadline_ns, ClockRef clock, int slot) noexcept {
  return estimator_.Adjust(pack, deadline_ns, clock, results_[static_cast<std::size_t>(slot)].get());
}

void EstimatorEngine::Execute(int slot, Estimate* estimate) noexcept {
  estimator_.Execute(*results_[static_cast<std::size_t>(slot)], estimate);
}

void EstimatorEngine::Reset() noexcept { estimator_.Reset(); }

}  // namespace armcmc::rt
