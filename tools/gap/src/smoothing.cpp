#include "armcmc/gap/smoothing.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace armcmc::gap {
namespace {

constexpr int kOrder = 3;

/// Row d of the result maps the samples of a window to the d-th derivative of their cubic at `position`.
Eigen::RowVectorXd Stencil(int window, double position, int derivative) {
  Matrix powers(window, kOrder + 1);
  const int half = window / 2;
  for (int i = 0; i < window; ++i)
    for (int p = 0; p <= kOrder; ++p) powers(i, p) = std::pow(static_cast<double>(i - half), p);
  Vector at = Vector::Zero(kOrder + 1);
  for (int p = derivative; p <= kOrder; ++p)
    at[p] = derivative == 0 ? std::pow(position, p) : p * std::pow(position, p - 1);
  return (powers.transpose() * powers).ldlt().solve(at).transpose() * powers.transpose();
}

Vector CentralDifference(const Vector& series) {
  const Eigen::Index n = series.size();
  Vector slope(n);
  slope.segment(1, n - 2) = 0.5 * (series.tail(n - 2) - series.head(n - 2));
  slope[0] = series[1] - series[0];
  slope[n - 1] = series[n - 1] - series[n - 2];
  return slope;
}

}  // namespace

Vector SavitzkyGolay(const Vector& series, int window, int derivative) {
  const Eigen::Index n = series.size();
  window = static_cast<int>(std::min<Eigen::Index>(window, n % 2 == 0 ? n - 1 : n));
  if (window < kOrder + 2) return derivative == 0 ? series : CentralDifference(series);
  const int half = window / 2;
  const Eigen::RowVectorXd inner = Stencil(window, 0.0, derivative);
  Vector out = Vector::Zero(n);
  for (int i = 0; i < window; ++i) out.segment(half, n - 2 * half) += inner[i] * series.segment(i, n - 2 * half);
  for (int i = 0; i < half; ++i) {
    out[i] = Stencil(window, i - half, derivative) * series.head(window);
    out[n - 1 - i] = Stencil(window, half - i, derivative) * series.tail(window);
  }
  return out;
}

int WidestWindow(const Vector& series, int widest) {
  // Fourth differences of a smooth motion vanish; those of noise of variance s^2 have the variance 70 s^2.
  constexpr double kGain = 70.0;
  constexpr double kAllowed = 2.0;      // variance that a window may remove, relative to the noise
  constexpr double kNegligible = 1e-6;  // share of the variance of the series that may be removed in any case
  const Eigen::Index n = series.size();
  if (n < 2 * widest) return 1;
  const Vector fourth = series.segment(0, n - 4) - 4.0 * series.segment(1, n - 4) + 6.0 * series.segment(2, n - 4) -
                        4.0 * series.segment(3, n - 4) + series.segment(4, n - 4);
  const double noise = fourth.squaredNorm() / (kGain * static_cast<double>(n - 4));
  const double variance = (series.array() - series.mean()).square().mean();
  for (int window = widest; window >= kOrder + 2; window -= 2) {
    const double removed = (series - SavitzkyGolay(series, window, 0)).squaredNorm() / static_cast<double>(n);
    if (removed <= kAllowed * noise + kNegligible * variance) return window;
  }
  return 1;
}

double LeftOfNoise(double noise_sd, int window) {
  // The cubic of a window passes 9 / (4 window) of the variance.
  return noise_sd * std::sqrt(2.25 / std::max(window, kOrder));
}

void AssignSide(const Vector& output, double noise_sd, Vector* position) {
  constexpr double kSure = 3.0;  // standard deviations
  const auto sure = [&](Eigen::Index i) { return std::abs((*position)[i]) > kSure * noise_sd; };
  const Eigen::Index rows = position->size();
  for (Eigen::Index first = 0; first < rows;) {
    if (sure(first)) {
      ++first;
      continue;
    }
    Eigen::Index end = first + 1;
    while (end < rows && !sure(end)) ++end;
    const double before = first > 0 ? (*position)[first - 1] : 0.0, after = end < rows ? (*position)[end] : 0.0;
    for (Eigen::Index i = first; i < end && before * after < 0.0; ++i) {
      const bool as_before = std::abs(output[i] - output[first - 1]) < std::abs(output[i] - output[end]);
      const double depth = std::max(std::abs((*position)[i]), std::numeric_limits<double>::min());
      (*position)[i] = std::copysign(depth, as_before ? before : after);
    }
    first = end;
  }
}

Vector Leaky(const Vector& series, double tau_samples, double start) {
  const double keep = std::exp(-1.0 / tau_samples);
  Vector out(series.size());
  double state = start * series[0];
  for (Eigen::Index i = 0; i < series.size(); ++i) {
    state = keep * state + (1.0 - keep) * series[i];
    out[i] = state;
  }
  return out;
}

}  // namespace armcmc::gap
