#pragma once

#include "armcmc/nonblocking.hpp"
#include "armcmc/settings.hpp"

namespace armcmc {

/// Law of the measurement noise, log p(e) with e in units of the target, scale s:
///
///   Gaussian   -e^2 / (2 s^2) - log s - log(2 pi) / 2
///   Student-t  -(nu + 1)/2 log(1 + e^2 / (nu s^2)) - log s + log[Gamma((nu+1)/2) / (Gamma(nu/2) sqrt(nu pi))]
///   Laplace    -|e| / s - log(2 s)
///   Mixture    log[(1 - w) N(e; s) + w N(e; c s)]            w = outlier_weight, c = outlier_scale
///
/// and the constants of the law that a step needs, computed once.
class NoiseModel {
 public:
  NoiseModel() = default;
  /// Integrates the law numerically. @pre settings are valid.
  explicit NoiseModel(const NoiseSettings& settings);

  /// log p(e) for scale s, in nats. @rt bounded.
  [[nodiscard]] double LogDensity(double e, double scale) const noexcept ARMCMC_NONBLOCKING;
  /// Weight of a squared residual in iteratively reweighted least squares: -(d log p / de) / e.
  [[nodiscard]] double SquareWeight(double e, double scale) const noexcept ARMCMC_NONBLOCKING;
  /// Deviance 2 (log p(0) - log p(e)) >= 0: e^2 / s^2 for the Gaussian.
  [[nodiscard]] double Deviance(double e, double scale) const noexcept ARMCMC_NONBLOCKING;

  [[nodiscard]] NoiseKind kind() const noexcept { return settings_.kind; }
  [[nodiscard]] const NoiseSettings& settings() const noexcept { return settings_; }
  [[nodiscard]] double log_constant() const noexcept { return log_constant_; }    ///< Additive part without -log s.
  [[nodiscard]] double deviance_mean() const noexcept { return deviance_mean_; }  ///< E[Deviance] under the law.
  [[nodiscard]] double deviance_sd() const noexcept { return deviance_sd_; }
  [[nodiscard]] double log_density_mean() const noexcept { return log_density_mean_; }  ///< E[log p] for s = 1.
  [[nodiscard]] double log_density_sd() const noexcept { return log_density_sd_; }
  [[nodiscard]] double information() const noexcept {
    return information_;
  }  ///< Fisher information of location for s = 1.
  [[nodiscard]] double scale_information() const noexcept {
    return scale_information_;
  }  ///< Of log s, for each sample.

 private:
  NoiseSettings settings_;
  double log_constant_ = 0.0, deviance_mean_ = 1.0, deviance_sd_ = 1.0;
  double log_density_mean_ = 0.0, log_density_sd_ = 1.0, information_ = 1.0, scale_information_ = 2.0;
};

}  // namespace armcmc
