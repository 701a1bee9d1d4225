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

/// @param squares  Sum of squared errors.
/// @param count    Of rows.
/// @param normal   J' J and J' e in units of the spread; the prior is added.
void AddPrior(const Problem& problem, const Eigen::VectorXd& theta, double squares, Eigen::Index count,
              Normal* normal) {
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

Normal NormalEquations(const Problem& problem, const FitResult& fit) {
  Eigen::MatrixXd jacobian = fit.jacobian(problem.rows, Eigen::all);
  jacobian *= problem.spread.asDiagonal();
  const Eigen::VectorXd error = (problem.model.target() - fit.prediction)(problem.rows);
  Normal normal{jacobian.transpose() * jacobian, jacobian.transpose() * error};
  AddPrior(problem, fit.theta, error.squaredNorm(), error.size(), &normal);
  return normal;
}

/// Where steps of these dampings lead, a column each.
Eigen::MatrixXd Steps(const Problem& problem, const Eigen::VectorXd& theta, const Normal& normal,
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

/// From a hundredth of `damping` up.
std::vector<double> Dampings(double damping) {
  constexpr std::size_t kTrials = 8;
  constexpr double kRatio = 8.0;
  std::vector<double> dampings{damping / (kRatio * kRatio)};
  while (dampings.size() < kTrials) dampings.push_back(kRatio * dampings.back());
  return dampings;
}

Problem MakeProblem(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows) {
  return {model,         Counted(model, rows),  model.Lower(), model.Upper(),
          model.Start(), PriorPrecision(model), model.Spread()};
}

/// @param wanted      Rows that predictions are needed at; null: all.
/// @param least_gain  Of the cost by one step: less ends the fit.
FitResult FitFrom(const Problem& problem, const std::vector<Eigen::Index>* wanted, const Eigen::VectorXd& start,
                  int max_iterations, double least_gain) {
  const TrajectoryModel& model = problem.model;
  FitResult fit;
  fit.theta = start.cwiseMax(problem.lower).cwiseMin(problem.upper);
  if (problem.rows.empty() || !model.Linearise(fit.theta, &fit.prediction, &fit.jacobian, wanted)) return fit;
  fit.valid = true;
  fit.cost = problem.Cost(fit.theta, fit.prediction);
  double damping = 1e-2;
  Eigen::MatrixXd predictions;
  for (; fit.iterations < max_iterations; ++fit.iterations) {
    const Eigen::MatrixXd thetas = Steps(problem, fit.theta, NormalEquations(problem, fit), Dampings(damping));
    model.Predict(thetas, &predictions, wanted);
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
    if (!model.Linearise(fit.theta, &fit.prediction, &fit.jacobian, wanted)) {
      fit.valid = false;
      return fit;
    }
    if (gain < least_gain) break;
  }
  fit.error_sd = std::sqrt(MeanSquare(model, problem.rows, fit.prediction));
  return fit;
}

/// Derivatives at some rows by differences to one side, in units of the spread.
bool Differences(const TrajectoryModel& model, const Eigen::VectorXd& theta, const std::vector<Eigen::Index>& rows,
                 const Eigen::VectorXd& spread, Eigen::MatrixXd* jacobian) {
  constexpr double kStep = 1e-5;
  Eigen::MatrixXd thetas = theta.replicate(1, theta.size() + 1), predictions;
  const Eigen::VectorXd upper = model.Upper();
  for (Eigen::Index d = 0; d < theta.size(); ++d)
    thetas(d, d) += theta[d] + kStep * spread[d] > upper[d] ? -kStep * spread[d] : kStep * spread[d];
  model.Predict(thetas, &predictions, &rows);
  if (!predictions.row(0).allFinite()) return false;
  const Eigen::VectorXd here = predictions.col(theta.size())(rows);
  jacobian->resize(here.size(), theta.size());
  for (Eigen::Index d = 0; d < theta.size(); ++d)
    jacobian->col(d) = (predictions.col(d)(rows) - here) * (spread[d] / (thetas(d, d) - theta[d]));
  return true;
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

FitResult Fit(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows, const Eigen::VectorXd& start,
              int max_iterations) {
  const Problem problem = MakeProblem(model, rows);
  return FitFrom(problem, nullptr, start, max_iterations, 1e-3 + 1e-7 * static_cast<double>(problem.rows.size()));
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
                  const std::vector<Eigen::VectorXd>& starts, std::size_t most_fits, int max_iterations,
                  bool along_one) {
  constexpr int kAlong = 3, kFirst = 2;
  std::vector<FitResult> begins;
  for (const Eigen::VectorXd& start : starts) {
    FitResult fit = Fit(model, rows, along_one ? AlongOne(model, rows, start, kAlong) : start, kFirst);
    if (!fit.valid) continue;
    fit.prediction.resize(0);
    fit.jacobian.resize(0, 0);
    begins.push_back(std::move(fit));
  }
  std::stable_sort(begins.begin(), begins.end(),
                   [](const FitResult& a, const FitResult& b) { return a.cost < b.cost; });
  FitResult best;
  for (std::size_t b = 0; b < std::min(begins.size(), most_fits); ++b) {
    FitResult fit = Fit(model, rows, begins[b].theta, max_iterations);
    if (fit.valid && (!best.valid || fit.cost < best.cost)) best = std::move(fit);
  }
  return best;
}

FitsWithout FitWithoutEach(const TrajectoryModel& model, const FitResult& all, const std::vector<Eigen::Index>& rows,
                           const std::vector<std::vector<Eigen::Index>>& groups, int max_iterations) {
  constexpr int kWithTheSame = 2;
  constexpr double kMoves = 0.1;  // of the cost
  const std::vector<double> dampings{0.0, 1e-2, 1.0, 100.0};
  Problem problem = MakeProblem(model, std::vector<std::uint8_t>(model.num_rows(), 0));
  problem.rows = rows;
  const auto num_groups = static_cast<Eigen::Index>(groups.size());
  const auto trials = static_cast<Eigen::Index>(dampings.size());
  Eigen::MatrixXd jacobian = all.jacobian(rows, Eigen::all);
  jacobian *= problem.spread.asDiagonal();
  const Eigen::MatrixXd gram = jacobian.transpose() * jacobian;
  const Eigen::VectorXd error = (model.target() - all.prediction)(rows);

  FitsWithout fits{all.theta.replicate(1, num_groups), error.replicate(1, num_groups),
                   std::vector<Eigen::MatrixXd>(groups.size(), all.jacobian(rows, Eigen::all))};
  std::vector<Eigen::MatrixXd> part, gram_without;
  std::vector<Eigen::Index> moving;
  const auto squares_without = [&](const Eigen::VectorXd& e, Eigen::Index g) {
    return std::max(e.squaredNorm() - e(groups[static_cast<std::size_t>(g)]).squaredNorm(), 0.0);
  };
  const auto count_without = [&](Eigen::Index g) {
    return static_cast<Eigen::Index>(rows.size() - groups[static_cast<std::size_t>(g)].size());
  };
  const auto cost = [&](const Eigen::VectorXd& e, const Eigen::VectorXd& theta, Eigen::Index g) {
    const auto count = static_cast<double>(count_without(g));
    return 0.5 * count * std::log(squares_without(e, g) / count + 1e-300) +
           0.5 * (theta - problem.mean).cwiseAbs2().dot(problem.precision);
  };
  for (Eigen::Index g = 0; g < num_groups; ++g) {
    part.emplace_back(jacobian(groups[static_cast<std::size_t>(g)], Eigen::all));
    gram_without.emplace_back(gram - part.back().transpose() * part.back());
    if (count_without(g) > 0) moving.push_back(g);
  }
  // Steps with the Jacobian of the fit to all rows tell most groups where to go, one with its own whether it is there.
  for (int iteration = 0; iteration <= kWithTheSame && !moving.empty(); ++iteration) {
    Eigen::MatrixXd thetas(all.theta.size(), static_cast<Eigen::Index>(moving.size()) * trials), predictions;
    for (std::size_t k = 0; k < moving.size(); ++k) {
      const Eigen::Index g = moving[k];
      const std::vector<Eigen::Index>& group = groups[static_cast<std::size_t>(g)];
      const Eigen::VectorXd e = fits.error.col(g), theta = fits.theta.col(g);
      Normal normal;
      Eigen::MatrixXd own;
      if (iteration == kWithTheSame && Differences(model, theta, rows, problem.spread, &own)) {
        fits.jacobian[static_cast<std::size_t>(g)] = own * problem.spread.cwiseInverse().asDiagonal();
        const Eigen::MatrixXd without = own(group, Eigen::all);
        normal = {own.transpose() * own - without.transpose() * without,
                  own.transpose() * e - without.transpose() * e(group)};
      } else {
        normal = {gram_without[static_cast<std::size_t>(g)],
                  jacobian.transpose() * e - part[static_cast<std::size_t>(g)].transpose() * e(group)};
      }
      AddPrior(problem, theta, squares_without(e, g), count_without(g), &normal);
      thetas.middleCols(static_cast<Eigen::Index>(k) * trials, trials) = Steps(problem, theta, normal, dampings);
    }
    model.Predict(thetas, &predictions, &rows);
    std::vector<Eigen::Index> still;
    for (std::size_t k = 0; k < moving.size(); ++k) {
      const Eigen::Index g = moving[k];
      const double before = cost(fits.error.col(g), fits.theta.col(g), g);
      double best = before;
      for (Eigen::Index c = static_cast<Eigen::Index>(k) * trials; c < static_cast<Eigen::Index>(k + 1) * trials; ++c) {
        if (!thetas.col(c).allFinite() || !std::isfinite(predictions(0, c))) continue;
        const Eigen::VectorXd e = (model.target() - predictions.col(c))(rows);
        const double its = cost(e, thetas.col(c), g);
        if (!(its < best)) continue;
        best = its;
        fits.theta.col(g) = thetas.col(c);
        fits.error.col(g) = e;
      }
      if (iteration < kWithTheSame || before - best > kMoves) still.push_back(g);
    }
    moving = std::move(still);
  }
  // Those that are not are fitted for themselves.
  for (const Eigen::Index g : moving) {
    std::vector<std::uint8_t> in_group(rows.size(), 0);
    for (const Eigen::Index k : groups[static_cast<std::size_t>(g)]) in_group[static_cast<std::size_t>(k)] = 1;
    problem.rows.clear();
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (in_group[k] == 0) problem.rows.push_back(rows[k]);
    const FitResult fit = FitFrom(problem, &rows, fits.theta.col(g), max_iterations, kMoves);
    if (!fit.valid) continue;
    fits.theta.col(g) = fit.theta;
    fits.error.col(g) = (model.target() - fit.prediction)(rows);
    fits.jacobian[static_cast<std::size_t>(g)] = fit.jacobian(rows, Eigen::all);
  }
  return fits;
}

Eigen::MatrixXd Covariance(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows, const FitResult& fit) {
  const Eigen::Index size = model.num_parameters();
  Eigen::MatrixXd information = PriorPrecision(model).asDiagonal();
  const double precision = 1.0 / (fit.error_sd * fit.error_sd + 1e-300);
  for (const Eigen::Index k : Counted(model, rows))
    information += precision * fit.jacobian.row(k).transpose() * fit.jacobian.row(k);
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  scaled.diagonal().array() += 1e-12;
  const Eigen::MatrixXd covariance = scaled.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
  return scale.asDiagonal() * covariance * scale.asDiagonal();
}

}  // namespace armcmc::identify
