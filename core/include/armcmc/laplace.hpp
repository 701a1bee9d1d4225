#pragma once

#include "armcmc/linear_algebra.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/noise_model.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/parameter_space.hpp"

namespace armcmc {

namespace simd {
struct Kernels;
}

/// A Gaussian in u: the prior that a Laplace fit combines with the likelihood, or its result.
struct Gaussian {
  ParamVector mean;
  ParamMatrix precision;
};

/// Scratch of LaplaceFit.
struct LaplaceScratch {
  ThetaTile theta;
  PredictionTile prediction;
};

/// The log-likelihood of a pack about u, as far as the parameters go (the noise scale stays where it is):
///
///   log L(v) = log L(u) + a' (v - u) - (v - u)' H (v - u) / 2
///
/// and where the parameters are v at the end of the pack and have moved towards it at a velocity w,
///
///   log L(v, w) = log L(v) - b' w + (v - u)' H_1 w - w' H_2 w / 2
struct LocalLikelihood {
  ParamVector gradient;     ///< a [num_parameters]
  ParamMatrix information;  ///< H, Fisher's, which unlike the curvature does not depend on the noise of the pack.
  // The same sums with the time in s from each sample to the end of the pack as a factor, and with its square.
  ParamVector lagged_gradient;           ///< b
  ParamMatrix lagged_information;        ///< H_1
  ParamMatrix twice_lagged_information;  ///< H_2
};
/// @param u  [num_parameters] @rt No heap, no lock, no throw. One batch.
[[nodiscard]] LocalLikelihood ExpandLikelihood(const simd::Kernels& kernels, int model, const ModeData& data,
                                               const NoiseModel& noise, const ParameterSpace& space,
                                               const ParamVector& u, double log_noise_scale,
                                               LaplaceScratch* scratch) noexcept ARMCMC_NONBLOCKING;

/// Mode and curvature of likelihood x Gaussian prior by a bounded number of Gauss-Newton steps:
///
///   H = J' W J + P,   step = (H + mu diag H)^-1 [J' W e + P (m - u)]
///
/// W are the reweighted-least-squares weights of the noise law. J comes from central differences evaluated as lanes of
/// one batch, so a model needs no derivatives. The batch about the end of the undamped step (mu = 0) evaluates its
/// gain, and is reused by the next iteration if the step is taken; damped, shorter and longer steps fill its other
/// lanes. Where none of them is uphill 4 dampings x 8 lengths are tried as lanes of a batch of their own. Steps are
/// clamped to the bounds of `space`. A step that promises less than `tolerance` is the last, and is taken without a
/// trial; H is then that at its beginning.
/// @param start      Where to begin, [dim].
/// @param tolerance  In nats: kModeTolerance for the mode itself, kProposalTolerance for something to draw from.
/// @param[out] fit   Mean = mode found, precision = H there. Positive definite because P is.
/// @return Log of likelihood x prior at the mode (without the prior's constant).
/// @rt No heap, no lock, no throw. At most 1 + kLaplaceIterations x 3 batches.
double LaplaceFit(const simd::Kernels& kernels, int model, const ModeData& data, const NoiseModel& noise,
                  const ParameterSpace& space, const Gaussian& prior, const ParamVector& start, double tolerance,
                  LaplaceScratch* scratch, Gaussian* fit) noexcept ARMCMC_NONBLOCKING;
inline constexpr int kLaplaceIterations = 14;
inline constexpr double kModeTolerance = 1e-6;
inline constexpr double kProposalTolerance = 1e-2;

}  // namespace armcmc
