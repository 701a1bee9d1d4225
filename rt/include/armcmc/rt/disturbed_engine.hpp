#pragma once

#include <array>

#include "armcmc/rt/injection.hpp"
#include "armcmc/rt/step_engine.hpp"

namespace armcmc::rt {

/// A StepEngine with the injected faults of adjust and execute around another one.
class DisturbedEngine final : public StepEngine {
 public:
  /// @param engine, injection  Outlive it.
  DisturbedEngine(StepEngine* engine, Injection* injection) noexcept : engine_(engine), injection_(injection) {}

  [[nodiscard]] PackFormat pack_format() const noexcept ARMCMC_NONBLOCKING override { return engine_->pack_format(); }
  [[nodiscard]] int num_modes() const noexcept ARMCMC_NONBLOCKING override { return engine_->num_modes(); }
  [[nodiscard]] int num_reported() const noexcept ARMCMC_NONBLOCKING override { return engine_->num_reported(); }
  [[nodiscard]] ReportedQuantity reported(int index) const noexcept ARMCMC_NONBLOCKING override {
    return engine_->reported(index);
  }
  [[nodiscard]] std::string_view mode_name(int mode) const noexcept ARMCMC_NONBLOCKING override {
    return engine_->mode_name(mode);
  }
  Status Adjust(const DataPack& pack, Nanos deadline_ns, ClockRef clock, int slot) noexcept ARMCMC_NONBLOCKING override;
  void Remember(ClockRef clock) noexcept ARMCMC_NONBLOCKING override { engine_->Remember(clock); }
  void Execute(int slot, Estimate* estimate) noexcept ARMCMC_NONBLOCKING override;
  void Reset() noexcept ARMCMC_NONBLOCKING override { engine_->Reset(); }

 private:
  StepEngine* engine_;
  Injection* injection_;
  std::array<std::int64_t, LatestValue::kSlots> pack_{};  // what each slot was computed from
  DataPack wrong_;
};

}  // namespace armcmc::rt
