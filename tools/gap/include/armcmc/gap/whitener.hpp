#pragma once

#include "armcmc/gap/types.hpp"

namespace armcmc::gap {

/// Autoregressive noise:  e_t = sum_k phi_k e_{t-k} + w_t,  w white with variance s2.
///
/// Before the first sample nothing is known: the first values are whitened by their stationary covariance.
///
/// Whitening turns residuals and derivatives into those of w, so that least squares is maximum likelihood and a sample
/// counts for what it adds.
struct Whitener {
  Vector phi;       ///< Empty: white already.
  double s2 = 1.0;  ///< Of w, squared unit of the output.

  [[nodiscard]] Vector Apply(const Vector& series) const;
  [[nodiscard]] Matrix Apply(const Matrix& columns) const;
  /// The series e whose whitened form is w.
  [[nodiscard]] Vector Colour(const Vector& white) const;
  /// Variance of e over that of w.
  [[nodiscard]] double Gain() const;
};

/// Order (at most 8) by the Bayesian information criterion, coefficients by Yule-Walker from the quieter half of the
/// blocks, variance from all of them.
[[nodiscard]] Whitener FitNoise(const Vector& residual);

}  // namespace armcmc::gap
