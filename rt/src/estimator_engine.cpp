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
  const int turn = estimator_.TurnOf(seq_);
  snapshots_->of(turn).adjusted.Write(
      seq_, [&](std::span<std::byte> out) noexcept { return estimator_.recursion(turn).SaveAdjusted(out); });
}

void EstimatorEngine::Execute(int slot, Estimate* estimate) noexcept {
  estimator_.Execute(*results_[static_cast<std::size_t>(slot)], estimate);
  if (snapshots_ != nullptr && warm_) {
    const int turn = estimator_.TurnOf(estimate->seq);
    snapshots_->of(turn).executed.Write(
        estimate->seq, [&](std::span<std::byte> out) noexcept { return estimator_.recursion(turn).SaveExecuted(out); });
  }
}

bool EstimatorEngine::Resume(std::span<const std::byte> adjusted, std::span<const std::byte> executed) {
  resumed_adjusted_ = SplitParts(adjusted, estimator_.overlap());
  resumed_executed_ = SplitParts(executed, estimator_.overlap());
  if (!resumed_adjusted_.empty() && !resumed_executed_.empty() && RestoreResumed()) return true;
  resumed_adjusted_.clear();
  resumed_executed_.clear();
  estimator_.Reset();
  return false;
}

bool EstimatorEngine::RestoreResumed() noexcept {
  bool good = true;
  for (std::size_t j = 0; j < resumed_adjusted_.size(); ++j) {
    // A recursion that had not had its first pack in both stages begins afresh.
    const bool some = estimator_.overlap() == 1 || (!resumed_adjusted_[j].empty() && !resumed_executed_[j].empty());
    if (some)
      good = estimator_.recursion(static_cast<int>(j)).Restore(resumed_adjusted_[j], resumed_executed_[j]) && good;
  }
  return good;
}

void EstimatorEngine::Reset() noexcept {
  estimator_.Reset();
  (void)RestoreResumed();
  warm_ = true;
}

}  // namespace armcmc::rt
