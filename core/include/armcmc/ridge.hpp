#pragma once

#include <array>

#include "armcmc/laplace.hpp"
#include "armcmc/linear_algebra.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/noise_model.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/parameter_space.hpp"

namespace armcmc {

/// One point of a ridge with the Gaussian that covers its surroundings.
struct RidgeAnchor {
  ParamVector mean;
  ParamMatrix covariance;
  double share = 0.0;  ///< Posterior mass near it by Laplace's method; shares sum to 1.
};
inline constexpr int kRidgeAnchors = 20;

/// Follows a bent ridge of likelihood x Gaussian prior: poor excitation leaves one direction nearly free, and the
/// posterior is a long, thin, curved valley that no single Gaussian covers.
///
/// The coordinate that is known worst is stepped through +-kRidgeReach of its standard deviations (inside its bounds);
/// at every step the others are fitted given it. Mass at a step: the conditional maximum times the root of the
/// conditional covariance's determinant. Each anchor's Gaussian has the step as its standard deviation along the ridge
/// and the conditional covariance across it.
/// @param count  Steps over the whole reach, raised to 6 and cut to kRidgeAnchors.
/// @return Number of anchors written, 0 when the fits failed.
/// @rt No heap, no lock, no throw. At most kRidgeAnchors Laplace fits.
int FollowRidge(const simd::Kernels& kernels, int model, const ModeData& data, const NoiseModel& noise,
                const ParameterSpace& space, const Gaussian& prior, const Gaussian& fit, int count,
                LaplaceScratch* scratch, std::array<RidgeAnchor, kRidgeAnchors>* anchors) noexcept ARMCMC_NONBLOCKING;

}  // namespace armcmc
