#pragma once

#include <array>

#include "armcmc/density_block.hpp"
#include "armcmc/linear_algebra.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

/// The posterior of one mode, compressed to what the next pack of that mode needs: drawable, with a density.
///
/// Up to two blocks: the parameters that persisted and, after a suspected change, those drawn anew. Each block is
/// unimodal; together they are not.
struct PosteriorMemory {
  static constexpr int kMaxBlocks = 2;

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
};

}  // namespace armcmc
