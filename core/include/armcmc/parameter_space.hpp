#pragma once

#include <array>

#include "armcmc/model.hpp"
#include "armcmc/noise_model.hpp"
#include "armcmc/settings.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

/// The sampled parameters in standardised coordinates u, and the initial prior P_0 on them.
///
///   theta_d = offset_d + scale_d u_d,  u_d ~ N(0, 1) or U(-sqrt 3, sqrt 3), truncated to [lower_d, upper_d]
///
/// Every prior has sd 1 in u before truncation, so that parameters five orders of magnitude apart look alike to the
/// sampler. When the noise scale is estimated it is the last coordinate, on a log scale: log s = offset + scale u.
struct ParameterSpace {
  int dim = 0;             ///< Sampled coordinates.
  int num_parameters = 0;  ///< Of the model; dim - 1 when the noise scale is sampled.
  std::array<double, kMaxParams> offset{}, scale{}, lower{}, upper{};
  std::array<double, kMaxParams> normal{};    ///< 1 for a normal prior, 0 for a uniform one.
  std::array<double, kMaxParams> prior_sd{};  ///< Of P_0 after truncation.
  double norm = 1.0;                          ///< P_0(u) = norm exp(-1/2 sum_d normal_d u_d^2) inside the bounds.
  double log_noise_scale = 0.0;               ///< log s when the scale is not sampled.

  ParameterSpace() = default;
  ParameterSpace(const EstimatorSettings& settings, const NoiseSettings& noise);

  [[nodiscard]] bool samples_noise_scale() const noexcept { return dim > num_parameters; }
  [[nodiscard]] double Theta(int d, double u) const noexcept {
    const auto i = static_cast<std::size_t>(d);
    return offset[i] + scale[i] * u;
  }
  [[nodiscard]] double LogNoiseScale(const double* u) const noexcept {
    return samples_noise_scale() ? Theta(dim - 1, u[dim - 1]) : log_noise_scale;
  }
};

}  // namespace armcmc
