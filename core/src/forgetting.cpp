#include "armcmc/forgetting.hpp"

#include <algorithm>
#include <cmath>

namespace armcmc {
namespace {

constexpr double kAllowance = 3.0;  // standard deviations of zeta that are attributed to chance

}  // namespace

Mismatch EvaluateMismatch(const ForgettingSettings& settings, const NoiseModel& noise, double noise_scale,
                          const ModeData& data, const PredictiveMoments& predictive) noexcept {
  const int samples = data.num_samples;
  const double n = samples;
  const double noise_variance = noise_scale * noise_scale;
  double error = 0.0, deviance = 0.0, variance = 0.0, log_density = 0.0, log_expected = 0.0;
  for (int i = 0; i < samples; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double e = data.target[k] - predictive.mean[k] - noise.settings().mean;
    const double v = predictive.variance[k] / noise_variance;
    error += e;
    deviance += noise.Deviance(e, noise_scale);
    variance += v;
    // The predictive density as the noise law widened by the predictive variance.
    const double widening = std::sqrt(1.0 + noise.information() * v);
    log_density += noise.LogDensity(e, noise_scale * widening);
    log_expected += noise.log_density_mean() - std::log(noise_scale * widening);
  }
  error /= n;
  deviance /= n;
  variance *= noise.information() / n;

  // For every law, d E[deviance] / d log s = -2 and d E[log density] / d log s = -1 at the true s.
  const double log_noise_variance = predictive.log_noise_sd * predictive.log_noise_sd;
  Mismatch m;
  double excess = 0.0;
  switch (settings.index) {
    case MismatchIndex::kSignedMean:
      m.zeta = error / noise_scale;
      m.allowance =
          kAllowance * std::sqrt(1.0 / (noise.information() * n) + predictive.variance_of_mean / noise_variance);
      excess = std::fabs(m.zeta - settings.mu);
      break;
    case MismatchIndex::kRms: {
      const double expected = std::sqrt(noise.deviance_mean() + variance);
      m.zeta = std::sqrt(deviance) - expected;
      // Delta method; the predictive error is one draw shared by all samples, hence its term has no factor 1/n.
      m.allowance = kAllowance *
                    std::sqrt(noise.deviance_sd() * noise.deviance_sd() / n + 2.0 * variance * variance +
                              4.0 * log_noise_variance) /
                    (2.0 * expected);
      excess = m.zeta - settings.mu;
      break;
    }
    case MismatchIndex::kLogPredictive:
      m.zeta = (log_expected - log_density) / n;
      m.allowance = kAllowance *
                    std::sqrt(noise.log_density_sd() * noise.log_density_sd() / n +
                              0.5 * variance * variance / ((1.0 + variance) * (1.0 + variance)) + log_noise_variance);
      excess = m.zeta - settings.mu;
      break;
  }
  // A few samples at the end of a contact count in proportion: they must not discard the information of whole packs.
  const double weight = std::sqrt(data.pack_share);
  m.threshold = settings.threshold / weight + m.allowance;
  if (!(excess < m.threshold)) {  // also true for a NaN
    m.decision = Decision::kModification;
    m.lambda = 0.0;
    return m;
  }
  m.decision = Decision::kReinforcement;
  m.lambda = std::min(std::exp(-weight * std::fmax(0.0, excess - m.allowance)), settings.lambda_max);
  return m;
}

}  // namespace armcmc
