#pragma once

#include "armcmc/density_fit.hpp"

namespace armcmc {

/// Fits the bends and tapers of a block whose mean and whitening are set; see DensityBlock.
///
/// @param scratch As for FitBlock. Holds the straightened coordinates of the draws afterwards, before any taper.
/// @return false, with block->bent false, if they are not significant.
/// @rt No heap, no lock, no throw. O(size dim^2).
bool FitBends(const simd::Kernels& kernels, const WeightedDraws& draws, double* const* scratch,
              DensityBlock* block) noexcept ARMCMC_NONBLOCKING;

}  // namespace armcmc
