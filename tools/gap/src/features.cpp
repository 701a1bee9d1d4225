#include "armcmc/gap/features.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "armcmc/expression/elementary.hpp"

namespace armcmc::gap {
namespace {

constexpr double kLowestCycles = 10.0;   // of a line in the recording; slower ones are drifts
constexpr double kHighestShare = 0.2;    // of the sampling rate
constexpr std::size_t kNeighbours = 30;  // on each side, for the background of the spectrum

/// Largest length up to n whose prime factors are 2, 3 and 5: a transform of any other is slow.
Eigen::Index SmoothLength(Eigen::Index n) {
  for (;; --n) {
    Eigen::Index rest = n;
    for (const Eigen::Index factor : {2, 3, 5})
      while (rest % factor == 0) rest /= factor;
    if (rest == 1) return n;
  }
}

Vector OfEach(expression::Op op, const Vector& of) {
  constexpr std::size_t kStride = expression::kElementaryStride;
  const auto count = static_cast<std::size_t>(of.size()), whole = count / kStride * kStride;
  Vector result(of.size());
  expression::Elementary(op, whole, of.data(), nullptr, result.data());
  std::array<double, kStride> rest{}, result_of_rest{};
  std::copy(of.data() + whole, of.data() + count, rest.begin());
  expression::Elementary(op, kStride, rest.data(), nullptr, result_of_rest.data());
  std::copy_n(result_of_rest.begin(), count - whole, result.data() + whole);
  return result;
}

}  // namespace

Vector Exp(const Vector& of) { return OfEach(expression::Op::kExp, of); }
Vector Tanh(const Vector& of) { return OfEach(expression::Op::kTanh, of); }
Vector Sin(const Vector& of) { return OfEach(expression::Op::kSin, of); }
Vector Cos(const Vector& of) { return OfEach(expression::Op::kCos, of); }

std::vector<double> Sorted(const Vector& series, const Vector& mask) {
  std::vector<double> sorted;
  for (Eigen::Index i = 0; i < series.size(); ++i)
    if (mask[i] != 0.0) sorted.push_back(series[i]);
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

Vector QuantileKnots(const Vector& series, const Vector& mask, int count) {
  return QuantileKnots(Sorted(series, mask), count);
}

Vector QuantileKnots(const std::vector<double>& sorted, int count) {
  std::vector<double> knots;
  for (int k = 0; k < count && !sorted.empty(); ++k) {
    const double share = 0.01 + 0.98 * k / (count - 1);
    const double knot = sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
    if (knots.empty() || knot > knots.back()) knots.push_back(knot);
  }
  return Eigen::Map<Vector>(knots.data(), static_cast<Eigen::Index>(knots.size()));
}

Vector EvenKnots(int count) { return Vector::LinSpaced(count, 0.0, 1.0); }

Matrix HatFunctions(const Vector& series, const Vector& knots) {
  Matrix hats = Matrix::Zero(series.size(), knots.size());
  if (knots.size() == 0) return hats;
  for (Eigen::Index i = 0; i < series.size(); ++i) {
    const double u = series[i];
    const auto above = std::upper_bound(knots.data(), knots.data() + knots.size(), u) - knots.data();
    if (above == 0) {
      hats(i, 0) = 1.0;
    } else if (above == knots.size()) {
      hats(i, above - 1) = 1.0;
    } else {
      const double share = (u - knots[above - 1]) / (knots[above] - knots[above - 1]);
      hats(i, above - 1) = 1.0 - share;
      hats(i, above) = share;
    }
  }
  return hats;
}

Matrix Gated(const Matrix& columns, const Vector& weight) { return weight.asDiagonal() * columns; }

Matrix JoinColumns(const Matrix& left, const Matrix& right) {
  Matrix both(left.rows(), left.cols() + right.cols());
  both << left, right;
  return both;
}

Matrix Products(const Matrix& a, const Matrix& b) {
  Matrix products(a.rows(), a.cols() * b.cols());
  for (Eigen::Index i = 0; i < a.cols(); ++i)
    for (Eigen::Index j = 0; j < b.cols(); ++j) products.col(i * b.cols() + j) = a.col(i).cwiseProduct(b.col(j));
  return products;
}

Vector Bristle(const Vector& velocity, double distance, double dt) {
  Vector deflection = Exp(velocity.cwiseAbs() * (-dt / distance));
  double z = 0.0;
  for (Eigen::Index i = 0; i < velocity.size(); ++i) {
    const double v = velocity[i];
    const double end = v > 0.0 ? 1.0 : (v < 0.0 ? -1.0 : z);
    z = end + (z - end) * deflection[i];
    deflection[i] = z;
  }
  return deflection;
}

Line StrongestLine(const Vector& series, double dt) {
  // Too short for any line to have cycles enough.
  if (kHighestShare * static_cast<double>(series.size()) <= kLowestCycles) return {};
  const Eigen::Index n = SmoothLength(series.size());
  const double mean = series.head(n).mean();
  std::vector<double> windowed(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) {
    const double hann = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n));
    windowed[static_cast<std::size_t>(i)] = (series[i] - mean) * hann;
  }
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> spectrum;
  fft.fwd(spectrum, windowed);
  const auto half = static_cast<std::size_t>(n / 2);
  std::vector<double> power(half);
  for (std::size_t k = 0; k < half; ++k) power[k] = std::norm(spectrum[k]);
  const double resolution = 1.0 / (static_cast<double>(n) * dt);
  const auto lowest = static_cast<std::size_t>(kLowestCycles);
  const auto highest = static_cast<std::size_t>(kHighestShare / dt / resolution);
  Line line;
  std::vector<double> window;
  for (std::size_t k = lowest; k < std::min(highest, half); ++k) {
    // Only peaks: the background is costly.
    if (k + 1 < half && (power[k] < power[k + 1] || power[k] < power[k - 1])) continue;
    const std::size_t first = k > kNeighbours ? k - kNeighbours : 0;
    const std::size_t last = std::min(half, k + kNeighbours + 1);
    window.assign(power.begin() + static_cast<std::ptrdiff_t>(first),
                  power.begin() + static_cast<std::ptrdiff_t>(last));
    const auto middle = window.begin() + static_cast<std::ptrdiff_t>(window.size() / 2);
    std::nth_element(window.begin(), middle, window.end());
    const double prominence = power[k] / (*middle + 1e-300);
    if (prominence > line.prominence) {
      // The peak of the parabola through the logarithms of three neighbours.
      const double before = std::log(power[k - 1] + 1e-300), here = std::log(power[k] + 1e-300);
      const double after = std::log(power[k + 1 < half ? k + 1 : k] + 1e-300);
      const double curvature = before - 2.0 * here + after;
      const double offset = curvature < 0.0 ? 0.5 * (before - after) / curvature : 0.0;
      line = {(static_cast<double>(k) + std::clamp(offset, -0.5, 0.5)) * resolution, prominence};
    }
  }
  return line;
}

Matrix Waves(const Vector& t, double frequency, int first_harmonic, int last_harmonic) {
  Matrix waves(t.size(), 2 * (last_harmonic - first_harmonic + 1));
  for (int h = first_harmonic; h <= last_harmonic; ++h) {
    const Vector phase = 2.0 * std::numbers::pi * frequency * h * t;
    waves.col(2 * (h - first_harmonic)) = Cos(phase);
    waves.col(2 * (h - first_harmonic) + 1) = Sin(phase);
  }
  return waves;
}

}  // namespace armcmc::gap
