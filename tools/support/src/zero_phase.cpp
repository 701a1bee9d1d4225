#include "zero_phase.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace armcmc::support {
namespace {

/// One pass of a Butterworth filter of order 2 (bilinear transform), at rest in its first value.
class Butterworth {
 public:
  Butterworth(double dt, double cutoff_hz) {
    const double k = std::tan(std::numbers::pi * cutoff_hz * dt);
    const double norm = 1.0 / (1.0 + std::numbers::sqrt2 * k + k * k);
    b0_ = k * k * norm;
    a1_ = 2.0 * (k * k - 1.0) * norm;
    a2_ = (1.0 - std::numbers::sqrt2 * k + k * k) * norm;
  }

  void Run(std::vector<double>* x) const {
    double x1 = x->front(), x2 = x1, y1 = x1, y2 = x1;
    for (double& v : *x) {
      const double y = b0_ * (v + 2.0 * x1 + x2) - a1_ * y1 - a2_ * y2;
      x2 = x1;
      x1 = v;
      y2 = y1;
      y1 = y;
      v = y;
    }
  }

 private:
  double b0_, a1_, a2_;
};

/// `count` samples beyond the end of a series: those of the polynomial that fits its last `window` samples by least
/// squares for as long as that window, then on along its tangent.
std::vector<double> Continued(const std::vector<double>& x, std::size_t window, std::size_t count) {
  constexpr Eigen::Index kDegree = 4;
  constexpr Eigen::Index kSpare = 4;  // samples beyond the number of coefficients, at least
  const auto rows = static_cast<Eigen::Index>(std::min(x.size(), std::max<std::size_t>(window, kDegree + kSpare)));
  const Eigen::Index degree = std::clamp<Eigen::Index>(rows - kSpare, 1, kDegree);
  const auto length = static_cast<double>(rows - 1);
  Eigen::MatrixXd powers(rows, degree + 1);
  Eigen::VectorXd last(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double from_end = (static_cast<double>(i) - length) / length;
    last[i] = x[x.size() - static_cast<std::size_t>(rows - i)];
    powers(i, 0) = 1.0;
    for (Eigen::Index d = 1; d <= degree; ++d) powers(i, d) = powers(i, d - 1) * from_end;
  }
  const Eigen::VectorXd c = powers.householderQr().solve(last);
  std::vector<double> beyond(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double to = static_cast<double>(k + 1) / length;
    const double at = std::min(to, 1.0);
    double value = 0.0;
    double slope = 0.0;
    for (Eigen::Index d = degree; d >= 0; --d) {
      slope = slope * at + value;
      value = value * at + c[d];
    }
    beyond[k] = value + slope * (to - at);
  }
  return beyond;
}

}  // namespace

std::vector<double> ZeroPhase(const std::vector<double>& x, double dt, double bandwidth_hz) {
  // Two passes of -1.5 dB each at the bandwidth.
  const double cutoff = bandwidth_hz / std::pow(std::numbers::sqrt2 - 1.0, 0.25);
  if (x.size() < 4 || cutoff * dt >= 0.5) return x;
  const double period = 1.0 / (bandwidth_hz * dt);
  const auto window = static_cast<std::size_t>(std::ceil(period)) + 1;
  const auto pad = std::min(x.size() - 1, static_cast<std::size_t>(std::ceil(3.0 * period)));
  std::vector<double> all = Continued({x.rbegin(), x.rend()}, window, pad);
  std::reverse(all.begin(), all.end());
  all.insert(all.end(), x.begin(), x.end());
  const std::vector<double> after = Continued(x, window, pad);
  all.insert(all.end(), after.begin(), after.end());
  const Butterworth filter(dt, cutoff);
  for (int pass = 0; pass < 2; ++pass) {
    filter.Run(&all);
    std::reverse(all.begin(), all.end());
  }
  const auto first = all.begin() + static_cast<std::ptrdiff_t>(pad);
  return {first, first + static_cast<std::ptrdiff_t>(x.size())};
}

std::vector<double> Derivative(const std::vector<double>& x, double dt) {
  const std::size_t n = x.size();
  std::vector<double> d(n);
  for (std::size_t i = 2; i + 2 < n; ++i) d[i] = (8.0 * (x[i + 1] - x[i - 1]) - (x[i + 2] - x[i - 2])) / (12.0 * dt);
  for (const std::size_t i : {std::size_t{1}, n - 2}) d[i] = (x[i + 1] - x[i - 1]) / (2.0 * dt);
  d[0] = (-3.0 * x[0] + 4.0 * x[1] - x[2]) / (2.0 * dt);
  d[n - 1] = (3.0 * x[n - 1] - 4.0 * x[n - 2] + x[n - 3]) / (2.0 * dt);
  return d;
}

double SuitableBandwidth(const std::vector<double>& x, double dt) {
  double square = 0.0;
  for (std::size_t i = 3; i < x.size(); ++i) {
    const double d = x[i] - 3.0 * x[i - 1] + 3.0 * x[i - 2] - x[i - 3];
    square += d * d;
  }
  // 1 + 9 + 9 + 1 of the noise's variance.
  const double noise = std::sqrt(square / (20.0 * std::max<double>(1.0, static_cast<double>(x.size()) - 3.0)));
  double bandwidth = 0.25 / dt;
  while (true) {
    const double next = bandwidth / 1.25;
    if (next * dt * static_cast<double>(x.size()) <= 10.0) break;
    const std::vector<double> smooth = ZeroPhase(x, dt, next);
    double taken = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) taken += (x[i] - smooth[i]) * (x[i] - smooth[i]);
    if (std::sqrt(taken / static_cast<double>(x.size())) > 1.5 * noise) break;
    bandwidth = next;
  }
  return bandwidth;
}

}  // namespace armcmc::support
