// Prediction of a pack before it is processed.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "estimator_impl.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr double kNothingToExpect = std::numeric_limits<double>::quiet_NaN();
/// Index of the sorted draw one standard deviation above the median: the 27th of 32 normal draws is expected 0.937
/// standard deviations above it.
constexpr std::size_t kUpper = 26;
constexpr double kUpperDeviation = 0.937;

/// (S P S') of sample k, in units of the noise's variance.
double StartVariance(const StartFit* start, std::size_t k) noexcept {
  double sum = 0.0;
  for (std::size_t j = 0; start != nullptr && j < static_cast<std::size_t>(start->count); ++j) {
    const double kept = 1.0 - start->shrink[j];
    sum += (1.0 / (kept * kept) - 1.0) * start->direction[j][k] * start->direction[j][k];
  }
  return sum;
}

/// Draws of the posterior after the last pack, moved and stretched to the mean and covariance of the prior of this one:
/// u <- m' + L' L^-1 (u - m), C = L L'. Draws are clamped to the bounds.
void MoveWithDrift(const ModeSampler::Drifted& drifted, const ParameterSpace& space, ThetaTile* theta) noexcept {
  ParamMatrix last, now;
  const Eigen::Index dim = space.num_parameters;
  if (!CholeskyFactor(drifted.last_covariance.topLeftCorner(dim, dim), &last) ||
      !CholeskyFactor(drifted.covariance.topLeftCorner(dim, dim), &now))
    return;
  const ParamMatrix map = Product(now, Inverse(last));
  if (!map.allFinite()) return;
  for (std::size_t lane = 0; lane < kTileLanes; ++lane) {
    ParamVector u(dim);
    for (Eigen::Index d = 0; d < dim; ++d) {
      const auto i = static_cast<std::size_t>(d);
      u[d] = (theta->value[i][lane] - space.offset[i]) / space.scale[i] - drifted.last_mean[d];
    }
    u = Multiply(map, u);
    for (Eigen::Index d = 0; d < dim; ++d) {
      const auto i = static_cast<std::size_t>(d);
      const double moved = std::clamp(drifted.mean[d] + u[d], space.lower[i], space.upper[i]);
      theta->value[i][lane] = space.Theta(static_cast<int>(d), moved);
    }
  }
}

}  // namespace

void Estimator::Forecast(const AdjustResult& result, PackForecast* forecast) noexcept {
  Impl& s = *impl_;
  forecast->num_samples = result.pack.num_samples;
  for (auto* row : {&forecast->target, &forecast->centre, &forecast->sd, &forecast->noise_std})
    row->fill(kNothingToExpect);
  if (result.status == Status::kBadPack || s.info.described == nullptr) return;
  for (int m = 0; m < s.info.num_modes; ++m) {
    const auto i = static_cast<std::size_t>(m);
    if (!s.known_draws[i]) continue;
    s.PrepareMode(result.pack, result.effects, m, &s.execute_data);
    const ModeData& data = s.execute_data;
    if (data.num_samples == 0) continue;
    ThetaTile theta = s.band_theta[i];
    const ModeSampler::Drifted& drifted = s.samplers[i]->drifted();
    if (drifted.any && drifted.at_s == data.time_s) MoveWithDrift(drifted, s.samplers[i]->space(), &theta);
    s.kernels.predict(s.model, data, theta, &s.band_prediction);
    const StartFit* start = s.state_filter.empty() ? nullptr : s.workspace->data[i].start_fit;
    const double noise = s.last_estimates[i].noise_std;
    for (std::size_t k = 0; k < static_cast<std::size_t>(data.num_samples); ++k) {
      const auto n = static_cast<std::size_t>(data.sample[k]);
      std::array<double, Impl::kBandDraws> law = s.band_prediction.value[k];
      std::sort(law.begin(), law.end());
      const double spread = 0.5 * (law[kUpper] - law[Impl::kBandDraws - 1 - kUpper]) / kUpperDeviation;
      forecast->target[n] = data.target[k];
      forecast->centre[n] = 0.5 * (law[Impl::kBandDraws / 2 - 1] + law[Impl::kBandDraws / 2]);
      forecast->sd[n] = std::sqrt(spread * spread + noise * noise * StartVariance(start, k));
      forecast->noise_std[n] = noise;
    }
  }
}

}  // namespace armcmc
