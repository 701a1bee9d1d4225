#pragma once

#include <array>
#include <cstdint>

#include "armcmc/data_pack.hpp"
#include "armcmc/effects/flow_pack.hpp"
#include "armcmc/effects/flow_plan.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/nonblocking.hpp"

namespace armcmc {

/// Packs of the soft actuator as the scoring kernels read them, with what a slow valve remembers of the packs before.
///
/// A sample belongs to the valve that is told to open. Behind a slow valve it belongs to none where the other one may
/// still be open, and where the memory is too short to say how far it is: after a start and after a lost pack.
class FlowRows {
 public:
  explicit FlowRows(const FlowPlan& plan);

  /// @pre pack.Validate() == kOk. @rt No heap, no lock, no throw. O(samples).
  void Prepare(const DataPack& pack, FlowPack* out) noexcept ARMCMC_NONBLOCKING;
  /// The samples of one mode.
  static void Fill(const FlowPack& flow, int mode, ModeData* data) noexcept ARMCMC_NONBLOCKING;
  /// Forgets the packs before.
  void Reset() noexcept { seq_ = -1; }

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
