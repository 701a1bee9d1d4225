#pragma once

#include <cstdint>
#include <vector>

#include "armcmc/adjust_result.hpp"
#include "armcmc/estimate.hpp"
#include "armcmc/model.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/parameter_space.hpp"

namespace armcmc {

namespace simd {
struct Kernels;
}

/// Scratch of Summarise, sized once.
struct SummaryWorkspace {
  explicit SummaryWorkspace(int capacity);
  const simd::Kernels& kernels;
  std::vector<double> value;          ///< Of every candidate.
  std::vector<double> visited_value;  ///< Of the candidates that the chain visited, one after the other.
  std::vector<double> visits;         ///< Theirs.
  std::vector<std::int32_t> visited;  ///< Which ones they are.
};

/// Mean, sd, quantiles, histogram of every reported quantity, point estimates and chain diagnostics.
///
/// AR-AP is the mean of the draws by their importance weights, the expectation of the chain's mean with less chance in
/// it; AR-MAP the mode after a modification and the mean after a reinforcement. Standard deviation and quantiles are
/// those of the chain after burn-in (its second half). Quantiles come from a histogram of kQuantileBins bins over the
/// range of the draws, linear within a bin.
/// @pre draws.updated.
/// @rt No heap, no lock, no throw. O(draws).
void Summarise(const ModelInfo& info, const PlantConstants& constants, const ParameterSpace& space,
               const ModeDraws& draws, SummaryWorkspace* workspace, ModeEstimate* estimate) noexcept ARMCMC_NONBLOCKING;
inline constexpr int kQuantileBins = 4096;

/// Widens the published marginals of a mode that no pack has updated for some time: standard deviation, quantiles and
/// histogram, about the median and within the bounds of the parameter. Point estimates stay.
///
/// A reported quantity r(theta) becomes wider by sum_d (dr/dtheta_d)^2 sd_d^2 (ratio_d^2 - 1) in variance.
/// @param ratio  Standard deviation of every sampled parameter over what it was at the update, at least 1; 0: unknown,
///               and nothing changes.
/// @rt No heap, no lock, no throw. O(dim reported).
void Widen(const ModelInfo& info, const PlantConstants& constants, const ParameterSpace& space,
           const std::array<double, kMaxParams>& ratio, ModeEstimate* estimate) noexcept ARMCMC_NONBLOCKING;

/// Moves the published marginals from the effective parameters of a pack to those at its end: point estimates by the
/// shift, standard deviation, quantiles and histogram about the median by the ratio as well, within the bounds.
/// @pre draws.moves.
/// @rt No heap, no lock, no throw. O(dim reported).
void MoveToEnd(const ModelInfo& info, const PlantConstants& constants, const ParameterSpace& space,
               const ModeDraws& draws, ModeEstimate* estimate) noexcept ARMCMC_NONBLOCKING;

/// Effective sample size of the chain after burn-in by non-overlapping batch means, the smallest over the coordinates.
[[nodiscard]] double ChainEss(const ModeDraws& draws) noexcept ARMCMC_NONBLOCKING;

}  // namespace armcmc
