#pragma once

#include <string_view>

#include "armcmc/data_pack.hpp"
#include "armcmc/gap_watch/gap_state.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/output_predictor.hpp"

namespace armcmc {

class SnapshotReader;
class SnapshotWriter;

/// Watches an equation of a plant whose constants are known and not estimated, as GapWatch does the one that is.
class OutputWatch {
 public:
  OutputWatch() = default;
  OutputWatch(const OutputWatch&) = delete;
  OutputWatch& operator=(const OutputWatch&) = delete;
  virtual ~OutputWatch() = default;

  /// One pack, in the order of the estimator. @param shown  The estimates on display.
  /// @pre pack.Validate() == kOk, and the pack is of the watch's plant.
  /// @rt No heap, no lock, no throw. O(samples), and at the end of a block O(packs of the block).
  virtual void Step(const DataPack& pack, const ShownEstimates& shown) noexcept ARMCMC_NONBLOCKING = 0;
  virtual void Reset() noexcept ARMCMC_NONBLOCKING = 0;
  [[nodiscard]] virtual const GapState& state() const noexcept ARMCMC_NONBLOCKING = 0;
  /// Name of a check by its index in GapState; empty where it is none of this equation.
  [[nodiscard]] virtual std::string_view CheckName(int check) const noexcept = 0;
  /// The evidence of the blocks that were judged, and the alarm. The block under way is not kept.
  virtual void Save(SnapshotWriter* out) const noexcept ARMCMC_NONBLOCKING = 0;
  virtual void Restore(SnapshotReader* in) noexcept ARMCMC_NONBLOCKING = 0;
};

}  // namespace armcmc
