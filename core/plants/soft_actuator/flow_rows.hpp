#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

#include "armcmc/data_pack.hpp"
#include "armcmc/effects/effect_rows.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/nonblocking.hpp"
#include "plants/soft_actuator/flow_pack.hpp"
#include "plants/soft_actuator/flow_plan.hpp"

namespace armcmc {

inline constexpr std::string_view kRateUnit = "Pa/s";  ///< Of what is regressed in place of the flow.

/// Packs of the actuator as the scoring kernels read them, with what a slow valve remembers of the packs before.
///
/// A sample belongs to the valve that is commanded to open. Behind a slow valve it belongs to none where the other one
/// may still be open, and where the memory is too short to say how far it is: after a start and after a lost pack.
///
/// What is regressed is the pressure rate (see FlowLaw), whose noise is that of a sensor, so that the noise of the
/// settings is in Pa/s; each valve has its own amplitudes.
class FlowRows final : public EffectRows {
 public:
  explicit FlowRows(const FlowPlan& plan);

  [[nodiscard]] const FlowPlan& plan() const noexcept { return plan_; }
  [[nodiscard]] std::unique_ptr<CompiledPack> MakePack() const override;
  [[nodiscard]] std::string_view target_unit() const noexcept override { return kRateUnit; }
  [[nodiscard]] bool Prepare(const DataPack& pack, CompiledPack* out) noexcept ARMCMC_NONBLOCKING override;
  void Fill(const DataPack& pack, const CompiledPack& rows, int mode,
            ModeData* data) const noexcept ARMCMC_NONBLOCKING override;
  void Reset() noexcept ARMCMC_NONBLOCKING override { seq_ = -1; }

 private:
  static constexpr std::size_t kRows = kMaxFlowHistory + kMaxPackSamples;
  /// Commands of the packs before that this one still feels, moved to the front.
  void Recall(const DataPack& pack) noexcept ARMCMC_NONBLOCKING;

  FlowPlan plan_;
  std::int64_t seq_ = -1, run_id_ = 0;
  double dt_ = 0.0;
  int rows_ = 0, history_ = 0, unsure_ = 0;        ///< unsure_: samples to come whose spool is not known.
  std::array<double, kRows> command_{}, spool_{};  ///< spool_ after each command, at the typical time constant.
  double before_ = 0.0;                            ///< Spool before the first of them.
  double slowest_ = 0.0;                           ///< Spool at the longest time constant.
};

}  // namespace armcmc
