#include "armcmc/gap/whitener.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace armcmc::gap {
namespace {

constexpr int kMaxOrder = 8;
constexpr double kMinImprovement = 6.0;  // nats of the criterion that a further lag must bring

}  // namespace

Vector Whitener::Apply(const Vector& series) const {
  Vector out = series;
  for (Eigen::Index k = 0; k < phi.size(); ++k)
    out.tail(series.size() - k - 1) -= phi[k] * series.head(series.size() - k - 1);
  return out;
}

Matrix Whitener::Apply(const Matrix& columns) const {
  Matrix out = columns;
  const Eigen::Index n = columns.rows();
  for (Eigen::Index c = 0; c < columns.cols(); ++c)
    for (Eigen::Index k = 0; k < phi.size(); ++k) out.col(c).tail(n - k - 1) -= phi[k] * columns.col(c).head(n - k - 1);
  return out;
}

Vector Whitener::Colour(const Vector& white) const {
  Vector out = white;
  for (Eigen::Index t = 1; t < out.size(); ++t)
    for (Eigen::Index k = 0; k < std::min<Eigen::Index>(phi.size(), t); ++k) out[t] += phi[k] * out[t - 1 - k];
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
  const Vector centred = residual.array() - residual.mean();
  const Eigen::Index n = centred.size();
  Vector covariance(kMaxOrder + 1);
  for (int k = 0; k <= kMaxOrder; ++k)
    covariance[k] = centred.head(n - k).dot(centred.tail(n - k)) / static_cast<double>(n);
  Whitener best{Vector(), std::max(covariance[0], 1e-300)};
  double best_criterion = static_cast<double>(n) * std::log(best.s2);
  for (int order = 1; order <= kMaxOrder; ++order) {
    Matrix toeplitz(order, order);
    for (int i = 0; i < order; ++i)
      for (int j = 0; j < order; ++j) toeplitz(i, j) = covariance[std::abs(i - j)];
    const Vector phi = toeplitz.ldlt().solve(covariance.segment(1, order));
    const double s2 = covariance[0] - phi.dot(covariance.segment(1, order));
    if (!(s2 > 0.0)) break;
    const double criterion = static_cast<double>(n) * std::log(s2) + order * std::log(static_cast<double>(n));
    if (criterion < best_criterion - kMinImprovement) {
      best_criterion = criterion;
      best = {phi, s2};
    }
  }
  return best;
}

}  // namespace armcmc::gap
