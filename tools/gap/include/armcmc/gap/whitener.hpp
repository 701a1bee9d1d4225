#pragma once

#include "armcmc/gap/types.hpp"

namespace armcmc::gap {

/// Autoregressive noise:  e_t = sum_k phi_k e_{t-k} + w_t,  w white with variance s^2.
///
/// The first values are whitened by their stationary covariance.
///
/// Whitened residuals and derivatives are those of w, so that least squares is maximum likelihood.
struct Whitener {
  Vector phi;             ///< Empty: e is white.
  double variance = 1.0;  ///< s^2, of w, squared unit of the output.

  [[nodiscard]] Vector Apply(const Vector& series) const;
  [[nodiscard]] Matrix Apply(const Matrix& columns) const;
  /// Inverse of whitening: the series e for a given w.
  [[nodiscard]] Vector Colour(const Vector& white) const;
  /// Variance of e divided by that of w.
  [[nodiscard]] double Gain() const;
};

/// Order (at most 8) by the Bayesian information criterion, coefficients by Yule-Walker from the quieter half of the
/// blocks, variance from all of them.
[[nodiscard]] Whitener FitNoise(const Vector& residual);

}  // namespace armcmc::gap
