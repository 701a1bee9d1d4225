#include "armcmc/adjust_result.hpp"
#include "armcmc/plant/program.hpp"
#include "armcmc/rt/step_engine.hpp"

namespace armcmc::rt {

PackFormat PackFormatOf(const Estimator& estimator) noexcept {
  PackFormat format{
      .plant = estimator.plant(), .num_inputs = estimator.num_inputs(), .overlap = estimator.settings().overlap};
  if (const PlantProgram* plant = estimator.settings().plant.get(); plant != nullptr) {
    format.name = plant->plant().description().name;
    format.fingerprint = plant->plant().fingerprint();
  }
  return format;
}

EstimatorEngine::EstimatorEngine(const EstimatorSettings& settings) : estimator_(settings) {
  for (auto& result : results_) result = estimator_.MakeResult();
}

EstimatorEngine::~EstimatorEngine() = default;

PackFormat EstimatorEngine::pack_format() const noexcept { return PackFormatOf(estimator_.first()); }
int EstimatorEngine::num_modes() const noexcept { return estimator_.first().num_modes(); }
int EstimatorEngine::num_reported() const noexcept { return estimator_.first().num_reported(); }
ReportedQuantity EstimatorEngine::reported(int index) const noexcept { return estimator_.first().reported(index); }
std::string_view EstimatorEngine::mode_name(int mode) const noexcept { return estimator_.first().mode_name(mode); }

Status EstimatorEngine::Adjust(const DataPack& pack, Nanos deadline_ns, ClockRef clock, int slot) noexcept {
  const Status status = estimator_.Draw(pack, deadline_ns, clock, results_[static_cast<std::size_t>(slot)].get());
  learnt_ = status == Status::kOk || status == Status::kTruncated;
  seq_ = pack.seq;
  return status;
}

void EstimatorEngine::Remember(ClockRef clock) noexcept {
  estimator_.Remember(clock);
  if (snapshots_ == nullptr || !warm_ || !learnt_) return;
  learnt_ = false;
  snapshots_->adjusted.Write(
      seq_, [this](std::span<std::byte> out) noexcept { return estimator_.first().SaveAdjusted(out); });
}

void EstimatorEngine::Execute(int slot, Estimate* estimate) noexcept {
  estimator_.Execute(*results_[static_cast<std::size_t>(slot)], estimate);
  if (snapshots_ != nullptr && warm_) {
    snapshots_->executed.Write(
        estimate->seq, [this](std::span<std::byte> out) noexcept { return estimator_.first().SaveExecuted(out); });
  }
}

bool EstimatorEngine::Resume(std::span<const std::byte> adjusted, std::span<const std::byte> executed) {
  if (!estimator_.first().Restore(adjusted, executed)) return false;
  resumed_adjusted_.assign(adjusted.begin(), adjusted.end());
  resumed_executed_.assign(executed.begin(), executed.end());
  return true;
}

void EstimatorEngine::Reset() noexcept {
  estimator_.Reset();
  if (!resumed_adjusted_.empty()) (void)estimator_.first().Restore(resumed_adjusted_, resumed_executed_);
  warm_ = true;
}

}  // namespace armcmc::rt
