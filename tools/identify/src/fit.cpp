#include "armcmc/identify/fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace armcmc::identify {
namespace {

/// The rows that count.
std::vector<Eigen::Index> Counted(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows) {
  std::vector<Eigen::Index> counted;
  for (std::size_t n = 0; n < rows.size(); ++n)
    if (rows[n] != 0 && model.active()[n] != 0) counted.push_back(static_cast<Eigen::Index>(n));
  return counted;
}

double MeanSquare(const TrajectoryModel& model, const std::vector<Eigen::Index>& rows,
                  const Eigen::VectorXd& prediction) {
  double sum = 0.0;
  for (const Eigen::Index n : rows) sum += std::pow(model.target()[n] - prediction[n], 2);
  return sum / static_cast<double>(rows.size());
}

struct Problem {
  const TrajectoryModel& model;
  std::vector<Eigen::Index> rows;
  Eigen::VectorXd lower, upper, mean, precision, spread;

  [[nodiscard]] double Cost(const Eigen::VectorXd& theta, const Eigen::VectorXd& prediction) const {
    constexpr double kTiny = 1e-300;
    return 0.5 * static_cast<double>(rows.size()) * std::log(MeanSquare(model, rows, prediction) + kTiny) +
           0.5 * (theta - mean).cwiseAbs2().dot(precision);
  }
};

/// Normal equations in units of the prior's spread: what is small for one parameter is large for another.
struct Normal {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
};

Normal NormalEquations(const Problem& problem, const FitResult& fit) {
  const Eigen::Index size = fit.theta.size();
  Eigen::MatrixXd jacobian(static_cast<Eigen::Index>(problem.rows.size()), size);
  Eigen::VectorXd error(jacobian.rows());
  for (Eigen::Index k = 0; k < jacobian.rows(); ++k) {
    const Eigen::Index n = problem.rows[static_cast<std::size_t>(k)];
    jacobian.row(k) = fit.jacobian.row(n);
    error[k] = problem.model.target()[n] - fit.prediction[n];
  }
  jacobian *= problem.spread.asDiagonal();
  Normal normal{jacobian.transpose() * jacobian, jacobian.transpose() * error};
  // Errors weigh as much as they will after this step: those of a poor start would leave the prior alone.
  const Eigen::VectorXd unit = normal.matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = unit.asDiagonal() * normal.matrix * unit.asDiagonal();
  scaled.diagonal().array() += 1e-12;
  const Eigen::VectorXd step = unit.cwiseProduct(scaled.ldlt().solve(unit.cwiseProduct(normal.right)));
  const double precision = static_cast<double>(error.size()) / ((error - jacobian * step).squaredNorm() + 1e-300);
  normal.matrix *= precision;
  normal.right *= precision;
  const Eigen::VectorXd pull = problem.precision.cwiseProduct(problem.spread.cwiseAbs2());
  normal.matrix.diagonal() += pull;
  normal.right -= pull.cwiseProduct((fit.theta - problem.mean).cwiseQuotient(problem.spread));
  // A parameter at a bound that would leave it stays.
  for (Eigen::Index d = 0; d < size; ++d) {
    const bool held = (fit.theta[d] <= problem.lower[d] && normal.right[d] < 0.0) ||
                      (fit.theta[d] >= problem.upper[d] && normal.right[d] > 0.0);
    if (!held) continue;
    normal.matrix.row(d).setZero();
    normal.matrix.col(d).setZero();
    normal.matrix(d, d) = 1.0;
    normal.right[d] = 0.0;
  }
  return normal;
}

/// Steps for dampings from a hundredth of `damping` up, a column each.
Eigen::MatrixXd Steps(const Problem& problem, const FitResult& fit, double damping) {
  constexpr Eigen::Index kTrials = 8;
  constexpr double kRatio = 8.0;
  const Normal normal = NormalEquations(problem, fit);
  Eigen::MatrixXd thetas(fit.theta.size(), kTrials);
  // At unit diagonal, so that what is small in its unit is not lost beside what is large.
  const Eigen::VectorXd size = normal.matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd matrix = size.asDiagonal() * normal.matrix * size.asDiagonal();
  const Eigen::VectorXd right = size.cwiseProduct(normal.right);
  double scale = damping / (kRatio * kRatio);
  for (Eigen::Index trial = 0; trial < kTrials; ++trial) {
    Eigen::MatrixXd damped = matrix;
    damped.diagonal().array() += scale + 1e-12;
    const Eigen::VectorXd step = damped.ldlt().solve(right).cwiseProduct(size).cwiseProduct(problem.spread);
    thetas.col(trial) = (fit.theta + step).cwiseMax(problem.lower).cwiseMin(problem.upper);
    scale *= kRatio;
  }
  return thetas;
}

}  // namespace

Eigen::VectorXd PriorPrecision(const TrajectoryModel& model) {
  Eigen::VectorXd precision(model.num_parameters());
  for (Eigen::Index d = 0; d < precision.size(); ++d) {
    const ParameterDescription& p = model.parameters()[static_cast<std::size_t>(d)];
    precision[d] = p.prior == "uniform" ? 0.0 : 1.0 / (p.sd * p.sd);
  }
  return precision;
}

namespace {

Problem MakeProblem(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows) {
  return {model,         Counted(model, rows),  model.Lower(), model.Upper(),
          model.Start(), PriorPrecision(model), model.Spread()};
}

}  // namespace

FitResult Fit(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows, const Eigen::VectorXd& start,
              int max_iterations) {
  const Problem problem = MakeProblem(model, rows);
  FitResult fit;
  fit.theta = start.cwiseMax(problem.lower).cwiseMin(problem.upper);
  if (problem.rows.empty() || !model.Linearise(fit.theta, &fit.prediction, &fit.jacobian)) return fit;
  fit.valid = true;
  fit.cost = problem.Cost(fit.theta, fit.prediction);
  double damping = 1e-2;
  Eigen::MatrixXd predictions;
  for (; fit.iterations < max_iterations; ++fit.iterations) {
    const Eigen::MatrixXd thetas = Steps(problem, fit, damping);
    model.Predict(thetas, &predictions);
    Eigen::Index best = -1;
    double cost = fit.cost;
    for (Eigen::Index trial = 0; trial < thetas.cols(); ++trial) {
      if (!thetas.col(trial).allFinite() || !std::isfinite(predictions(0, trial))) continue;
      const double its = problem.Cost(thetas.col(trial), predictions.col(trial));
      if (its < cost) {
        cost = its;
        best = trial;
      }
    }
    const double gain = fit.cost - cost;
    if (best < 0) {
      if (damping > 1e6) break;
      damping *= 1e5;
      continue;
    }
    damping = std::clamp(damping * std::pow(8.0, static_cast<double>(best) - 2.0), 1e-7, 1e6);
    fit.theta = thetas.col(best);
    fit.cost = cost;
    if (!model.Linearise(fit.theta, &fit.prediction, &fit.jacobian)) {
      fit.valid = false;
      return fit;
    }
    if (gain < 1e-3 + 1e-7 * static_cast<double>(problem.rows.size())) break;
  }
  fit.error_sd = std::sqrt(MeanSquare(model, problem.rows, fit.prediction));
  return fit;
}

Eigen::VectorXd AlongOne(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows,
                         const Eigen::VectorXd& start, int steps) {
  const Problem problem = MakeProblem(model, rows);
  Eigen::VectorXd theta = start.cwiseMax(problem.lower).cwiseMin(problem.upper);
  Eigen::VectorXd prediction;
  Eigen::MatrixXd jacobian, predictions;
  for (int step = 0; step < steps && !problem.rows.empty(); ++step) {
    if (!model.Linearise(theta, &prediction, &jacobian)) break;
    const Eigen::VectorXd error = (model.target() - prediction)(problem.rows);
    Eigen::MatrixXd thetas = theta.replicate(1, theta.size() + 1);
    for (Eigen::Index d = 0; d < theta.size(); ++d) {
      const Eigen::VectorXd along = jacobian.col(d)(problem.rows);
      const double move = along.dot(error) / (along.squaredNorm() + 1e-300);
      thetas(d, d) = std::clamp(theta[d] + move, problem.lower[d], problem.upper[d]);
    }
    model.Predict(thetas, &predictions);
    Eigen::Index best = theta.size();
    for (Eigen::Index d = 0; d < theta.size(); ++d)
      if (std::isfinite(predictions(0, d)) &&
          problem.Cost(thetas.col(d), predictions.col(d)) < problem.Cost(thetas.col(best), predictions.col(best)))
        best = d;
    theta = thetas.col(best);
  }
  return theta;
}

FitResult BestFit(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows,
                  const std::vector<Eigen::VectorXd>& starts, std::size_t most_fits, int max_iterations) {
  const Problem problem = MakeProblem(model, rows);
  struct Begin {
    Eigen::VectorXd theta;
    double cost;
  };
  std::vector<Begin> begins;
  Eigen::VectorXd prediction;
  for (const Eigen::VectorXd& start : starts) {
    const Eigen::VectorXd theta = AlongOne(model, rows, start, 3);
    if (!problem.rows.empty() && model.PredictOne(theta, &prediction))
      begins.push_back({theta, problem.Cost(theta, prediction)});
  }
  std::stable_sort(begins.begin(), begins.end(), [](const Begin& a, const Begin& b) { return a.cost < b.cost; });
  FitResult best;
  for (std::size_t b = 0; b < std::min(begins.size(), most_fits); ++b) {
    FitResult fit = Fit(model, rows, begins[b].theta, max_iterations);
    if (fit.valid && (!best.valid || fit.cost < best.cost)) best = std::move(fit);
  }
  return best;
}

Eigen::VectorXd StandardDeviations(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows,
                                   const FitResult& fit) {
  const Eigen::Index size = model.num_parameters();
  Eigen::MatrixXd information = PriorPrecision(model).asDiagonal();
  const double precision = 1.0 / (fit.error_sd * fit.error_sd + 1e-300);
  for (const Eigen::Index k : Counted(model, rows))
    information += precision * fit.jacobian.row(k).transpose() * fit.jacobian.row(k);
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  scaled.diagonal().array() += 1e-12;
  const Eigen::MatrixXd covariance = scaled.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
  return covariance.diagonal().cwiseMax(0.0).cwiseSqrt().cwiseProduct(scale);
}

}  // namespace armcmc::identify
