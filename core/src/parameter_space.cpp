#include "armcmc/parameter_space.hpp"

#include <cmath>
#include <numbers>

namespace armcmc {
namespace {

double NormalCdf(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

}  // namespace

ParameterSpace::ParameterSpace(const EstimatorSettings& settings, const NoiseSettings& noise)
    : dim(settings.num_parameters + (noise.estimate_std ? 1 : 0)),
      num_parameters(settings.num_parameters),
      log_noise_scale(std::log(noise.std)) {
  for (int d = 0; d < dim; ++d) {
    const auto i = static_cast<std::size_t>(d);
    if (d == num_parameters) {
      constexpr double kReach = 6.0;
      offset[i] = log_noise_scale;
      scale[i] = noise.std_log_sd;
      lower[i] = -kReach;
      upper[i] = kReach;
      normal[i] = 1.0;
    } else {
      const ParameterSettings& p = settings.parameters[i];
      const bool is_normal = p.prior == PriorKind::kNormal;
      normal[i] = is_normal ? 1.0 : 0.0;
      offset[i] = is_normal ? p.mean : 0.5 * (p.lower + p.upper);
      scale[i] = is_normal ? p.sd : (p.upper - p.lower) / (2.0 * std::numbers::sqrt3);
      lower[i] = (p.lower - offset[i]) / scale[i];
      upper[i] = (p.upper - offset[i]) / scale[i];
    }
    const double mass = normal[i] > 0.0
                            ? (NormalCdf(upper[i]) - NormalCdf(lower[i])) * std::sqrt(2.0 * std::numbers::pi)
                            : upper[i] - lower[i];
    norm /= mass;
    // Moments of the truncated law by the midpoint rule: at set-up, for any bounds.
    constexpr int kNodes = 2000;
    const double from = std::fmax(lower[i], normal[i] > 0.0 ? -8.0 : lower[i]);
    const double to = std::fmin(upper[i], normal[i] > 0.0 ? 8.0 : upper[i]);
    double m0 = 0.0, m1 = 0.0, m2 = 0.0;
    for (int k = 0; k < kNodes; ++k) {
      const double u = from + (to - from) * (k + 0.5) / kNodes;
      const double w = std::exp(-0.5 * normal[i] * u * u);
      m0 += w;
      m1 += w * u;
      m2 += w * u * u;
    }
    prior_sd[i] = std::sqrt(std::fmax(m2 / m0 - m1 * m1 / (m0 * m0), 0.0));
  }
}

}  // namespace armcmc
