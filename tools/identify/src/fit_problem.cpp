#include "fit_problem.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace armcmc::identify {

double FitProblem::MeanSquare(const Eigen::VectorXd& prediction) const {
  double sum = 0.0;
  for (const Eigen::Index n : rows) sum += std::pow(model.target()[n] - prediction[n], 2);
  return sum / static_cast<double>(rows.size());
}

double FitProblem::Cost(const Eigen::VectorXd& theta, const Eigen::VectorXd& prediction) const {
  constexpr double kTiny = 1e-300;
  return 0.5 * static_cast<double>(rows.size()) * std::log(MeanSquare(prediction) + kTiny) +
         0.5 * (theta - mean).cwiseAbs2().dot(precision);
}

std::vector<Eigen::Index> CountedRows(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows) {
  std::vector<Eigen::Index> counted;
  for (std::size_t n = 0; n < rows.size(); ++n)
    if (rows[n] != 0 && model.active()[n] != 0) counted.push_back(static_cast<Eigen::Index>(n));
  return counted;
}

FitProblem MakeFitProblem(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows) {
  return {model,         CountedRows(model, rows), model.Lower(), model.Upper(),
          model.Start(), PriorPrecision(model),    model.Spread()};
}

void AddPrior(const FitProblem& problem, const Eigen::VectorXd& theta, double squares, Eigen::Index count,
              NormalSystem* normal) {
  // Errors weigh as much as they will after this step: those of a poor start would leave the prior alone.
  const Eigen::VectorXd unit = normal->matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = unit.asDiagonal() * normal->matrix * unit.asDiagonal();
  scaled.diagonal().array() += 1e-12;
  const Eigen::VectorXd step = unit.cwiseProduct(scaled.ldlt().solve(unit.cwiseProduct(normal->right)));
  const double left = squares - 2.0 * normal->right.dot(step) + step.dot(normal->matrix * step);
  const double precision = static_cast<double>(count) / (std::max(left, 1e-13 * squares) + 1e-300);
  normal->matrix *= precision;
  normal->right *= precision;
  const Eigen::VectorXd pull = problem.precision.cwiseProduct(problem.spread.cwiseAbs2());
  normal->matrix.diagonal() += pull;
  normal->right -= pull.cwiseProduct((theta - problem.mean).cwiseQuotient(problem.spread));
  // A parameter at a bound that would leave it stays.
  for (Eigen::Index d = 0; d < theta.size(); ++d) {
    const bool held = (theta[d] <= problem.lower[d] && normal->right[d] < 0.0) ||
                      (theta[d] >= problem.upper[d] && normal->right[d] > 0.0);
    if (!held) continue;
    normal->matrix.row(d).setZero();
    normal->matrix.col(d).setZero();
    normal->matrix(d, d) = 1.0;
    normal->right[d] = 0.0;
  }
}

Eigen::MatrixXd Steps(const FitProblem& problem, const Eigen::VectorXd& theta, const NormalSystem& normal,
                      const std::vector<double>& dampings) {
  Eigen::MatrixXd thetas(theta.size(), static_cast<Eigen::Index>(dampings.size()));
  // At unit diagonal, so that what is small in its unit is not lost beside what is large.
  const Eigen::VectorXd size = normal.matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd matrix = size.asDiagonal() * normal.matrix * size.asDiagonal();
  const Eigen::VectorXd right = size.cwiseProduct(normal.right);
  for (std::size_t trial = 0; trial < dampings.size(); ++trial) {
    Eigen::MatrixXd damped = matrix;
    damped.diagonal().array() += dampings[trial] + 1e-12;
    const Eigen::VectorXd step = damped.ldlt().solve(right).cwiseProduct(size).cwiseProduct(problem.spread);
    thetas.col(static_cast<Eigen::Index>(trial)) = (theta + step).cwiseMax(problem.lower).cwiseMin(problem.upper);
  }
  return thetas;
}

}  // namespace armcmc::identify
