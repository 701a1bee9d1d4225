#pragma once

#include <array>

#include "armcmc/data_pack.hpp"
#include "armcmc/expression/features.hpp"
#include "armcmc/last_pack.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/plant/program.hpp"
#include "armcmc/plant/state_run.hpp"

namespace armcmc {

namespace simd {
struct Kernels;
}

/// The output of a plant whose modes explain something else, as its file `predicts` it: simulated from pack to pack
/// with the parameters on display, from the inputs and from what is measured of its states.
class OutputTrajectory {
 public:
  /// @param prediction  Null: there is none. Must outlive this.
  OutputTrajectory(const PlantProgram* prediction, const simd::Kernels& kernels);

  [[nodiscard]] bool empty() const noexcept { return prediction_ == nullptr; }

  /// Processes a pack. A trajectory that is not finite, or that does not follow the previous pack, restarts at this
  /// one.
  /// @return false where something that is needed is not finite.
  /// @pre !empty(), pack.Validate() == kOk.
  /// @rt No heap, no lock, no throw. O(samples).
  [[nodiscard]] bool Prepare(const DataPack& pack) noexcept ARMCMC_NONBLOCKING;

  /// Goes to the end of the pack for the parameters in lane 0. The other lanes start where lane 0 does.
  /// @param theta  Parameters of the prediction.
  /// @param[out] output  [sample][lane]
  /// @pre Prepare() was true.
  /// @rt No heap, no lock, no throw. O(samples x operations).
  void Run(const ThetaTile& theta, PredictionTile* output) noexcept ARMCMC_NONBLOCKING;

  /// The next pack restarts the trajectory.
  void Reset() noexcept ARMCMC_NONBLOCKING;

 private:
  const PlantProgram* prediction_;
  const simd::Kernels& kernels_;
  LastPack last_;
  expression::FeatureMemory features_;
  StateMemory states_;
  PlantPack pack_;
  ModeData data_;
  StateTile no_offset_{}, end_{};
};

}  // namespace armcmc
