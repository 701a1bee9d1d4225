#pragma once

#include "armcmc/laplace.hpp"
#include "armcmc/linear_algebra.hpp"
#include "armcmc/nonblocking.hpp"

namespace armcmc {

/// Which velocities a filter has: of all parameters, of one that moves alone, or of none.
struct MovingParameters {
  Eigen::Index first = 0, count = 0;
};

/// How u and w change in some time without data, where w is an Ornstein-Uhlenbeck process (Drift):  u <- u + b w,  w <-
/// phi w, and noise with these variances and this covariance for each parameter that moves.
struct DriftStep {
  double phi = 1.0, b = 0.0;
  double noise_uu = 0.0, noise_uw = 0.0, noise_ww = 0.0;
};

/// What a pack tells of velocities, once its parameters are the effective ones v = u - T w (Drift):
///
///   log L = gradient' w - (v - mode)' mixed w - w' information w / 2
struct VelocityLikelihood {
  ParamVector mode;         ///< m
  ParamMatrix lead;         ///< T, s.
  ParamVector gradient;     ///< T' a - b
  ParamMatrix mixed;        ///< H T - H_1
  ParamMatrix information;  ///< T' H T - T' H_1 - H_1 T + H_2
};

/// A Gaussian of the standardised parameters u of a mode and their velocities w, and its probability: one of the bank
/// of Drift. All of them have the same number of parameters.
///
/// @rt Every member: no heap, no lock, no throw, O(dim^3).
struct DriftFilter {
  double weight = 0.0;     ///< 0: empty, the rest says nothing.
  ParamVector u, w;        ///< Means; prior standard deviations, and those per second.
  ParamMatrix uu, uw, ww;  ///< Covariance, in blocks.

  /// Times the likelihood of a pack expanded about `centre`, exp(a' (u - centre) - (u - centre)' H (u - centre) / 2).
  /// The weight stays.
  /// @return Log of the integral, not finite where the product is no Gaussian.
  double MultiplyBy(const LocalLikelihood& local, const ParamVector& centre) noexcept ARMCMC_NONBLOCKING;

  /// From u to v = u - T w, times what the pack tells of velocities.
  /// @return As above.
  double ToEffective(const VelocityLikelihood& pack) noexcept ARMCMC_NONBLOCKING;
  /// From v to u = v + T w.
  void FromEffective(const ParamMatrix& lead) noexcept ARMCMC_NONBLOCKING;

  /// u becomes to + map (u - from).
  void Transform(const ParamMatrix& map, const ParamVector& from, const ParamVector& to) noexcept ARMCMC_NONBLOCKING;

  /// A time without data. If the variance of a parameter would exceed that of P_0 by a factor c > 1, variance and mean
  /// are divided by c.
  void Propagate(const DriftStep& step, const MovingParameters& moving) noexcept ARMCMC_NONBLOCKING;

  /// Half the log of the determinant of the covariance of u and of those velocities; NaN where it is none.
  [[nodiscard]] double LogVolume(const MovingParameters& moving) const noexcept ARMCMC_NONBLOCKING;

  /// Makes this one the Gaussian with the moments of both, with the weight of both, and empties the other.
  void Absorb(DriftFilter* other) noexcept ARMCMC_NONBLOCKING;
};

/// Share of a variance that is kept, so that it does not grow beyond that of P_0.
[[nodiscard]] double KeptShare(double before, double grown) noexcept ARMCMC_NONBLOCKING;

}  // namespace armcmc
