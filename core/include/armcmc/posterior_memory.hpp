#pragma once

#include <array>

#include "armcmc/density_block.hpp"
#include "armcmc/linear_algebra.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

class SnapshotReader;
class SnapshotWriter;

/// The posterior of one mode, compressed to what the next pack of that mode needs: drawable, with a density.
///
/// Up to two blocks: the parameters that persisted, at rest and drifting or as one, and, after a suspected change,
/// those drawn anew. Each block is unimodal; together they are not. In the prior of a pack all three may have one
/// (Drift).
struct PosteriorMemory {
  static constexpr int kMaxBlocks = 3;
  static constexpr int kStoredBlocks = 2;  ///< After a pack.

  PosteriorMemory() = default;
  PosteriorMemory(const PosteriorMemory&) = delete;  // blocks point into `tables`
  PosteriorMemory& operator=(const PosteriorMemory&) = delete;

  bool valid = false;
  bool informed = false;  ///< Some parameter has ever been known better than its prior says.
  int num_blocks = 0;
  std::array<DensityBlock, kMaxBlocks> block;
  std::array<double, kMaxBlocks> weight{};  ///< Probabilities, the largest first.
  std::array<std::array<MarginalTable, kMaxParams>, kMaxBlocks> tables;
  ParamVector mean;  ///< Of the dominant block, with its covariance: what Gauss-Newton combines with a pack.
  ParamMatrix covariance;
  double log_noise_scale = 0.0;  ///< Posterior mean of log s.

  /// Asks for what a draw from it reads to be in the cache. @rt O(nodes of the tables).
  void Prefetch() const noexcept ARMCMC_NONBLOCKING;
  /// Everything above, for Restore(). @rt No heap, no lock, no throw. O(nodes of the tables).
  void Save(SnapshotWriter* out) const noexcept ARMCMC_NONBLOCKING;
  /// What was saved, bit by bit; in->good() is false if it cannot be a posterior of `dim` coordinates, and nothing is
  /// known then. @param shared  The table of blocks that have none of their own; outlives this.
  void Restore(int dim, const MarginalTable& shared, SnapshotReader* in) noexcept ARMCMC_NONBLOCKING;
};

}  // namespace armcmc
