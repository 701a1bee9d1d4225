#include "armcmc/gap/whitener.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "armcmc/gap/blocks.hpp"
#include "armcmc/support/wider_lanes.hpp"

namespace armcmc::gap {
namespace {

constexpr int kMaxOrder = 8;
constexpr Eigen::Index kChunk = 512;  // rows that stay in the fastest cache while all lags are subtracted
constexpr double kMinLagGain = 6.0;   // nats of the criterion that a further lag must bring

/// Autocovariances of the quieter half of the blocks. An effect that acts in a few events (a clipped peak) must not
/// pass for coloured noise: it would be whitened away.
Vector QuietCovariance(const Vector& series) {
  const auto edges = BlockEdges(series.size());
  const Vector energy = BlockSquares(series);
  Vector sorted = energy;
  std::nth_element(sorted.data(), sorted.data() + kNumBlocks / 2, sorted.data() + kNumBlocks);
  const double median = sorted[kNumBlocks / 2];
  Vector covariance = Vector::Zero(kMaxOrder + 1);
  double count = 0.0;
  for (std::size_t b = 0; b < kNumBlocks; ++b) {
    if (energy[static_cast<Eigen::Index>(b)] > median) continue;
    const auto block = series.segment(edges[b], edges[b + 1] - edges[b]);
    for (int k = 0; k <= kMaxOrder; ++k)
      covariance[k] += block.head(block.size() - k).dot(block.tail(block.size() - k)) *
                       static_cast<double>(block.size()) / static_cast<double>(block.size() - k);
    count += static_cast<double>(block.size());
  }
  return covariance / count;
}

/// Lower Cholesky factor of the covariance of the first phi.size() values of e, in units of s^2: nothing before them is
/// known, and they vary by more than w. Identity where phi is no stationary process.
Matrix StartFactor(const Vector& phi) {
  const Eigen::Index order = phi.size();
  // Yule-Walker for the autocovariances: g_k = sum_j phi_j g_|k-j| + [k = 0].
  Matrix equations = Matrix::Identity(order + 1, order + 1);
  for (Eigen::Index k = 0; k <= order; ++k)
    for (Eigen::Index j = 1; j <= order; ++j) equations(k, std::abs(k - j)) -= phi[j - 1];
  const Vector g = equations.partialPivLu().solve(Vector::Unit(order + 1, 0));
  Matrix covariance(order, order);
  for (Eigen::Index i = 0; i < order; ++i)
    for (Eigen::Index j = 0; j < order; ++j) covariance(i, j) = g[std::abs(i - j)];
  const Eigen::LLT<Matrix> factor(covariance);
  if (!covariance.allFinite() || factor.info() != Eigen::Success) return Matrix::Identity(order, order);
  return factor.matrixL();
}

/// What the lags leave of a series, from the first row on that has them all.
ARMCMC_FOR_WIDER_LANES void Innovations(const double* __restrict series, Eigen::Index rows,
                                        const double* __restrict phi, Eigen::Index order, double* __restrict out) {
  for (Eigen::Index first = order; first < rows; first += kChunk) {
    const Eigen::Index end = std::min(first + kChunk, rows);
    for (Eigen::Index t = first; t < end; ++t) out[t] = series[t] - phi[0] * series[t - 1];
    for (Eigen::Index k = 1; k < order; ++k)
      for (Eigen::Index t = first; t < end; ++t) out[t] -= phi[k] * series[t - k - 1];
  }
}

/// Of every column.
template <typename Columns>
Columns Whitened(const Whitener& noise, const Columns& columns) {
  const Vector& phi = noise.phi;
  const Eigen::Index n = columns.rows(), order = std::min(phi.size(), n);
  if (order == 0 || columns.size() == 0) return columns;
  Columns out(n, columns.cols());
  for (Eigen::Index c = 0; c < columns.cols(); ++c)
    Innovations(columns.data() + c * n, n, phi.data(), order, out.data() + c * n);
  const Matrix start = StartFactor(phi).topLeftCorner(order, order);
  out.topRows(order) = start.triangularView<Eigen::Lower>().solve(columns.topRows(order));
  return out;
}

}  // namespace

Vector Whitener::Apply(const Vector& series) const { return Whitened(*this, series); }

Matrix Whitener::Apply(const Matrix& columns) const { return Whitened(*this, columns); }

Vector Whitener::Colour(const Vector& white) const {
  Vector out = white;
  const Eigen::Index order = std::min(phi.size(), white.size());
  if (order > 0) out.head(order) = StartFactor(phi).topLeftCorner(order, order) * white.head(order);
  for (Eigen::Index t = order; t < out.size(); ++t)
    for (Eigen::Index k = 0; k < order; ++k) out[t] += phi[k] * out[t - 1 - k];
  return out;
}

double Whitener::Gain() const {
  constexpr int kHorizon = 2000;
  Vector response = Vector::Zero(kHorizon);
  response[0] = 1.0;
  for (int t = 1; t < kHorizon; ++t)
    for (Eigen::Index k = 0; k < std::min<Eigen::Index>(phi.size(), t); ++k)
      response[t] += phi[k] * response[t - 1 - k];
  return response.squaredNorm();
}

Whitener FitNoise(const Vector& residual) {
  const Eigen::Index n = residual.size() / 2;  // rows that the covariances are from
  const Vector covariance = QuietCovariance(residual.array() - residual.mean());
  Whitener best{Vector(), std::max(covariance[0], 1e-300)};
  double best_criterion = static_cast<double>(n) * std::log(best.variance);
  for (int order = 1; order <= kMaxOrder; ++order) {
    Matrix toeplitz(order, order);
    for (int i = 0; i < order; ++i)
      for (int j = 0; j < order; ++j) toeplitz(i, j) = covariance[std::abs(i - j)];
    const Vector phi = toeplitz.ldlt().solve(covariance.segment(1, order));
    const double variance = covariance[0] - phi.dot(covariance.segment(1, order));
    if (!(variance > 0.0)) break;
    const double criterion = static_cast<double>(n) * std::log(variance) + order * std::log(static_cast<double>(n));
    if (criterion < best_criterion - kMinLagGain) {
      best_criterion = criterion;
      best = {phi, variance};
    }
  }
  best.variance = std::max(best.Apply(residual).squaredNorm() / static_cast<double>(residual.size()), 1e-300);
  return best;
}

}  // namespace armcmc::gap
