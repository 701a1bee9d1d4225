#include "armcmc/gap/smoothing.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

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
