#include "widths.hpp"

#include <Eigen/Dense>

namespace armcmc::ladder {

using Eigen::Index;
using Eigen::VectorXd;

double Correlated(const Trial& trial, const std::vector<std::uint8_t>& rows) {
  constexpr double kNothing = 0.05;
  std::vector<double> e;
  for (std::size_t n = 0; n < rows.size(); ++n)
    if (rows[n] != 0 && trial.model->active()[n] != 0)
      e.push_back(trial.model->target()[static_cast<Index>(n)] - trial.fit.prediction[static_cast<Index>(n)]);
  const Eigen::Map<const VectorXd> x(e.data(), static_cast<Index>(e.size()));
  const double all = x.squaredNorm();
  double sum = 1.0;
  for (Index lag = 1; lag < x.size() / 4 && all > 0.0; ++lag) {
    const double r = x.head(x.size() - lag).dot(x.tail(x.size() - lag)) / all;
    if (r < kNothing) break;
    sum += 2.0 * r;
  }
  return sum;
}

Widths::Widths(const Trial& trial, const std::vector<std::uint8_t>& rows, double correlated) {
  const identify::TrajectoryModel& model = *trial.model;
  information_ = identify::PriorPrecision(model).asDiagonal();
  const double precision = 1.0 / (correlated * trial.fit.error_sd * trial.fit.error_sd + 1e-300);
  for (std::size_t n = 0; n < rows.size(); ++n) {
    if (rows[n] == 0 || model.active()[n] == 0) continue;
    const auto row = trial.fit.jacobian.row(static_cast<Index>(n));
    information_ += precision * row.transpose() * row;
  }
}

VectorXd Widths::Of(const std::vector<bool>& known) const {
  std::vector<Index> open;
  for (std::size_t d = 0; d < known.size(); ++d)
    if (!known[d]) open.push_back(static_cast<Index>(d));
  const Eigen::MatrixXd part = information_(open, open);
  const VectorXd scale = part.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * part * scale.asDiagonal();
  scaled.diagonal().array() += 1e-12;
  const auto size = static_cast<Index>(open.size());
  const Eigen::MatrixXd covariance = scaled.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
  VectorXd sd = VectorXd::Zero(static_cast<Index>(known.size()));
  sd(open) = covariance.diagonal().cwiseMax(0.0).cwiseSqrt().cwiseProduct(scale);
  return sd;
}

}  // namespace armcmc::ladder
