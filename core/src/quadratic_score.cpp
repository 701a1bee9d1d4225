#include "armcmc/quadratic_score.hpp"

#include <algorithm>
#include <cmath>

#include "simd/kernels.hpp"

namespace armcmc {
namespace {

/// Nats: the bound applies within a standard deviation of the prior, not to distant candidates.
constexpr double kConfirmed = 1e-4;

}  // namespace

QuadraticScore::QuadraticScore(const simd::Kernels& kernels, int model, const ParameterSpace& space,
                               const NoiseModel& noise, const LinearPart& part)
    : kernels_(kernels),
      model_(model),
      space_(space),
      noise_(noise),
      part_(part),
      applies_(part.num_linear > 0 && noise.kind() == NoiseKind::kGaussian) {
  if (!applies_) return;
  form_.num_linear = part.num_linear;
  form_.linear = part.linear;
  form_.curved = part.curved;
  if (part.curved < 0) return;
  const auto c = static_cast<std::size_t>(part.curved);
  form_.slope = 2.0 / (space.upper[c] - space.lower[c]);
  form_.origin = -1.0 - form_.slope * space.lower[c];
  CosineTable& table = transform_.emplace_back();
  for (std::size_t k = 0; k < kNodes; ++k)
    for (std::size_t j = 0; j < kNodes; ++j)
      table[k][j] = (k == 0 ? 1.0 : 2.0) / kNodes *
                    std::cos(3.14159265358979323846 * static_cast<double>(k) * (static_cast<double>(j) + 0.5) / kNodes);
}

void QuadraticScore::TakeSums(const ModeData& data, const DriftFactor* factor, QuadraticScratch* scratch) noexcept {
  const int lanes = part_.curved < 0 ? kTileLanes : kNodes;
  const auto tiles = static_cast<std::size_t>(part_.num_linear) + 1;
  for (int first = 0; first < lanes; first += kTileLanes) {
    ThetaTile& theta = scratch->theta;
    for (int d = 0; d < space_.num_parameters; ++d)
      theta.value[static_cast<std::size_t>(d)].fill(space_.Theta(d, form_.about[static_cast<std::size_t>(d)]));
    if (part_.curved >= 0)
      for (std::size_t l = 0; l < kTileLanes; ++l) {
        const double angle = 3.14159265358979323846 * (first + static_cast<double>(l) + 0.5) / kNodes;
        const double u = (std::cos(angle) - form_.origin) / form_.slope;
        theta.value[static_cast<std::size_t>(part_.curved)][l] = space_.Theta(part_.curved, u);
      }
    for (std::size_t i = 0; i < tiles; ++i) {
      if (i == 0) {
        kernels_.predict(model_, data, theta, &scratch->prediction[0]);
        continue;
      }
      const auto d = static_cast<std::size_t>(part_.linear[i - 1]);
      const double at = theta.value[d][0];
      theta.value[d].fill(at + space_.scale[d]);
      kernels_.predict(model_, data, theta, &scratch->prediction[i]);
      theta.value[d].fill(at);
    }
    std::array<double*, QuadraticForm::kMaxFunctions> rows{};
    for (std::size_t f = 0; f < rows.size(); ++f) rows[f] = &sums_[f][static_cast<std::size_t>(first)];
    kernels_.quadratic_sums(data, noise_.settings().mean, part_.num_linear, scratch->prediction.data(), rows.data());
    if (form_.num_levers == 0) continue;
    for (std::size_t f = 0; f < rows.size(); ++f) rows[f] = &lever_sums_[f][static_cast<std::size_t>(first)];
    kernels_.lever_node_sums(*factor, data, noise_.settings().mean, part_.num_linear, scratch->prediction.data(),
                             rows.data());
  }
}

int QuadraticScore::Degree(double variance) const noexcept {
  const int functions = QuadraticForm::Functions(part_.num_linear);
  const double tolerance = 2.0 * variance * kTolerance;
  constexpr double kRounding = 4e-16;
  double rest = 0.0;
  for (int f = 0; f < functions; ++f) {
    const auto& series = series_[static_cast<std::size_t>(f)];
    double sum = 0.0;
    for (const double c : series) sum += std::fabs(c);
    rest += kRounding * sum;
    for (std::size_t k = QuadraticForm::kMaxDegree + 1; k < kNodes; ++k) rest += std::fabs(series[k]);
  }
  if (!(rest <= tolerance)) return -1;
  int degree = QuadraticForm::kMaxDegree;
  for (; degree > 1; degree -= 2) {
    for (int f = 0; f < functions; ++f)
      for (const int k : {degree, degree - 1})
        rest += std::fabs(series_[static_cast<std::size_t>(f)][static_cast<std::size_t>(k)]);
    if (!(rest <= tolerance)) break;
  }
  return degree;
}

bool QuadraticScore::IsConfirmed(const ModeData& data, const DriftFactor* factor, const ParamVector& sd,
                                 QuadraticScratch* scratch) const noexcept {
  constexpr int kNear = kTileLanes / 2 - 1;  // odd, so that the centre is one of them
  constexpr double kReach = 4.0;             // standard deviations
  alignas(64) std::array<std::array<double, kTileLanes>, kMaxParams> rows;
  std::array<const double*, kMaxParams> u{};
  for (int d = 0; d < space_.dim; ++d) {
    const auto i = static_cast<std::size_t>(d);
    u[i] = rows[i].data();
    for (int l = 0; l < kTileLanes; ++l) {
      const double side = (l + d) % 2 == 0 ? 1.0 : -1.0;
      double x = form_.about[i] + side * sd[d];
      if (d == part_.curved && l < kNear) {
        x = form_.about[i] + sd[d] * kReach * (2.0 * l / (kNear - 1) - 1.0);
      } else if (d == part_.curved) {  // between the points, at unrelated places
        const double part = (l - kNear + 0.61803398874989485) / (kTileLanes - kNear);
        x = space_.lower[i] + part * (space_.upper[i] - space_.lower[i]);
      }
      rows[i][static_cast<std::size_t>(l)] = std::clamp(x, space_.lower[i], space_.upper[i]);
    }
  }
  alignas(64) std::array<double, kTileLanes> log_scale, by_samples, by_sums;
  kernels_.to_physical(space_, u.data(), 0, &scratch->theta, log_scale.data());
  kernels_.predict(model_, data, scratch->theta, &scratch->prediction[0]);
  kernels_.log_likelihood(noise_, data, scratch->prediction[0], log_scale.data(), by_samples.data());
  Score(u.data(), 0, by_sums.data());
  for (std::size_t l = 0; l < kTileLanes; ++l)
    if (!(std::fabs(by_sums[l] - by_samples[l]) <= kConfirmed + kTolerance * std::fabs(by_samples[l]))) return false;
  if (form_.num_levers == 0) return true;
  LeverTile levers, levers_by_sums;
  kernels_.lever_sums(*factor, noise_, data, scratch->prediction[0], log_scale.data(), &levers, by_samples.data());
  Levers(u.data(), 0, &levers_by_sums);
  for (int d = 0; d < form_.num_levers; ++d) {
    double largest = 1.0;
    for (const double v : levers.value[d]) largest = std::fmax(largest, std::fabs(v));
    for (int l = 0; l < kTileLanes; ++l)
      if (!(std::fabs(levers_by_sums.value[d][l] - levers.value[d][l]) <= kTolerance * largest)) return false;
  }
  return true;
}

void QuadraticScore::Interpolate(const std::array<double, kNodes>& sums, int terms, double* series) const noexcept {
  const CosineTable& transform = transform_[0];
  for (std::size_t k = 0; k < static_cast<std::size_t>(terms); ++k) {
    std::array<double, 4> part{};
    for (std::size_t j = 0; j < kNodes; j += 4)
      for (std::size_t l = 0; l < 4; ++l) part[l] += transform[k][j + l] * sums[j + l];
    series[k] = (part[0] + part[1]) + (part[2] + part[3]);
  }
}

void QuadraticScore::Prepare(const ModeData& data, const Gaussian& fit, QuadraticScratch* scratch,
                             const DriftFactor* factor) noexcept {
  ready_ = false;
  const ParamVector& about = fit.mean;
  if (!applies_ || data.start_fit != nullptr || !about.allFinite()) return;
  num_samples_ = data.num_samples;
  for (int d = 0; d < space_.dim; ++d) form_.about[static_cast<std::size_t>(d)] = about[d];
  form_.num_levers = factor != nullptr ? factor->dim : 0;
  const auto levers = static_cast<std::size_t>(form_.num_levers * (1 + part_.num_linear));
  if (levers > QuadraticForm::kMaxFunctions) return;
  TakeSums(data, factor, scratch);
  const auto functions = static_cast<std::size_t>(QuadraticForm::Functions(part_.num_linear));
  if (part_.curved < 0) {
    form_.degree = 0;
    ready_ = true;
    for (std::size_t f = 0; f < functions; ++f) {
      form_.coefficient[f][0] = sums_[f][0];
      ready_ = ready_ && std::isfinite(sums_[f][0]);
    }
    for (std::size_t f = 0; f < levers; ++f) {
      form_.lever[f][0] = lever_sums_[f][0];
      ready_ = ready_ && std::isfinite(lever_sums_[f][0]);
    }
    return;
  }
  for (std::size_t f = 0; f < functions; ++f) Interpolate(sums_[f], kNodes, series_[f].data());
  const double scale = std::exp(space_.LogNoiseScale(about.data()));
  const int degree = Degree(scale * scale);
  if (degree < 0) return;
  form_.degree = degree;
  for (std::size_t f = 0; f < functions; ++f)
    std::copy_n(series_[f].begin(), static_cast<std::size_t>(degree) + 1, form_.coefficient[f].begin());
  for (std::size_t f = 0; f < levers; ++f) Interpolate(lever_sums_[f], degree + 1, form_.lever[f].data());
  ParamVector sd = Inverse(fit.precision).diagonal();
  for (int d = 0; d < space_.dim; ++d) sd[d] = sd[d] > 0.0 ? std::sqrt(sd[d]) : 1.0;
  ready_ = IsConfirmed(data, factor, sd, scratch);
}

void QuadraticScore::Score(const double* const* u, int first, double* out) const noexcept {
  kernels_.score_quadratic(form_, space_, noise_, num_samples_, u, first, out);
}

void QuadraticScore::Levers(const double* const* u, int first, LeverTile* sums) const noexcept {
  kernels_.levers_quadratic(form_, space_, u, first, sums);
}

}  // namespace armcmc
