#include "armcmc/gap/band_noise.hpp"

#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <vector>

namespace armcmc::gap {
namespace {

constexpr Eigen::Index kSegment = 256;  // rows of a transform
constexpr Eigen::Index kLeastSegments = 8;
constexpr double kAbsent = 0.1;      // of the power of the residual, below which the law is absent
constexpr double kLeastBand = 0.25;  // of all frequencies
constexpr std::size_t kMostLags = 2;
constexpr double kLargest = 0.95;  // reflection coefficient
constexpr int kGridSteps = 38;     // of a reflection coefficient, on each side
constexpr double kLagCost = 6.0;   // nats that a further lag must bring

/// Mean periodogram of overlapping segments, without the mean frequency. [frequency]
Vector Spectrum(const Vector& series) {
  Eigen::FFT<double> fft;
  Vector power = Vector::Zero(kSegment / 2);
  std::vector<double> windowed(kSegment);
  std::vector<std::complex<double>> transform;
  Eigen::Index count = 0;
  double weight = 0.0;
  for (Eigen::Index first = 0; first + kSegment <= series.size(); first += kSegment / 2, ++count) {
    const double mean = series.segment(first, kSegment).mean();
    weight = 0.0;
    for (Eigen::Index i = 0; i < kSegment; ++i) {
      const double hann = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / kSegment);
      windowed[static_cast<std::size_t>(i)] = hann * (series[first + i] - mean);
      weight += hann * hann;
    }
    fft.fwd(transform, windowed);
    for (Eigen::Index j = 0; j < power.size(); ++j) power[j] += std::norm(transform[static_cast<std::size_t>(j) + 1]);
  }
  return power / (static_cast<double>(count) * weight);
}

}  // namespace

std::optional<Whitener> NoiseAboveBand(const Vector& residual, const Vector& predicted) {
  if (residual.size() < kLeastSegments * kSegment / 2) return std::nullopt;
  const Vector noise = Spectrum(residual), law = Spectrum(predicted);
  const Eigen::Index bins = noise.size();
  Eigen::Index first = bins;
  while (first > 0 && law[first - 1] < kAbsent * noise[first - 1]) --first;
  if (static_cast<double>(bins - first) < kLeastBand * static_cast<double>(bins)) return std::nullopt;
  const auto power = noise.tail(bins - first).array();
  const Eigen::ArrayXd angle =
      std::numbers::pi / static_cast<double>(bins) *
      Eigen::ArrayXd::LinSpaced(bins - first, static_cast<double>(first + 1), static_cast<double>(bins));
  // Real and imaginary parts of exp(-i w k).
  const std::array<Eigen::ArrayXd, kMostLags> real = {angle.cos(), (2.0 * angle).cos()};
  const std::array<Eigen::ArrayXd, kMostLags> imaginary = {-angle.sin(), -(2.0 * angle).sin()};
  // Each frequency of the segments stands for that many of the whole series.
  const double each = static_cast<double>(residual.size()) / 2.0 / static_cast<double>(bins);
  Whitener best;
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](const Vector& phi) {
    Eigen::ArrayXd re = Eigen::ArrayXd::Ones(power.size()), im = Eigen::ArrayXd::Zero(power.size());
    for (Eigen::Index k = 0; k < phi.size(); ++k) {
      re -= phi[k] * real[static_cast<std::size_t>(k)];
      im -= phi[k] * imaginary[static_cast<std::size_t>(k)];
    }
    const Eigen::ArrayXd filter = re.square() + im.square();
    const double variance = (power * filter).mean();
    const double cost = each * (static_cast<double>(power.size()) * std::log(variance) - filter.log().sum()) +
                        kLagCost * static_cast<double>(phi.size());
    if (!(cost < least)) return;
    least = cost;
    best = {phi, variance};
  };
  consider(Vector());
  const auto at = [](int step) { return kLargest * step / kGridSteps; };
  for (int one = -kGridSteps; one <= kGridSteps; ++one) {
    consider(Vector::Constant(1, at(one)));
    for (int two = -kGridSteps; two <= kGridSteps; ++two) {
      Vector phi(2);
      phi << at(one) * (1.0 - at(two)), at(two);
      consider(phi);
    }
  }
  return best;
}

}  // namespace armcmc::gap
