#include "levenberg_marquardt.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "forward_differences.hpp"

namespace armcmc::identify {
namespace {

constexpr double kRatio = 8.0;  ///< Of one damping to the next.
constexpr double kMaxDamping = 1e6;

/// The dampings that an iteration tries: two below `damping`, then up.
std::vector<double> Dampings(double damping) {
  constexpr std::size_t kTrials = 8;
  std::vector<double> dampings{damping / (kRatio * kRatio)};
  while (dampings.size() < kTrials) dampings.push_back(kRatio * dampings.back());
  return dampings;
}

/// As ForwardJacobian().
/// @param around  From TrajectoryModel::Around().
Eigen::MatrixXd CentralJacobian(const FitProblem& problem, const Eigen::MatrixXd& around,
                                const Eigen::Ref<const Eigen::MatrixXd>& predictions,
                                const std::vector<Eigen::Index>& rows) {
  Eigen::VectorXd prediction;
  Eigen::MatrixXd jacobian;
  if (!TrajectoryModel::LineariseFrom(around, predictions, &prediction, &jacobian)) return {};
  return jacobian(rows, Eigen::all) * problem.spread.asDiagonal();
}

}  // namespace

LevenbergMarquardt::LevenbergMarquardt(const FitProblem& problem, const Eigen::VectorXd& start, int max_iterations,
                                       double least_gain, Differences differences)
    : problem_(problem), max_iterations_(max_iterations), least_gain_(least_gain), differences_(differences) {
  fit_.theta = start.cwiseMax(problem.lower).cwiseMin(problem.upper);
  done_ = problem.rows.empty();
}

Eigen::MatrixXd LevenbergMarquardt::Request() {
  if (linearises_) {
    thetas_ =
        differences_ == Differences::kForward ? Displaced(problem_, fit_.theta) : problem_.model.Around(fit_.theta);
    return thetas_;
  }
  const Eigen::VectorXd error = (problem_.model.target() - fit_.prediction)(problem_.rows);
  NormalSystem normal{jacobian_.transpose() * jacobian_, jacobian_.transpose() * error};
  AddPrior(problem_, fit_.theta, error.squaredNorm(), error.size(), &normal);
  thetas_ = Steps(problem_, fit_.theta, normal, Dampings(damping_));
  return thetas_;
}

void LevenbergMarquardt::Receive(const Eigen::Ref<const Eigen::MatrixXd>& predictions) {
  if (linearises_)
    ReceiveLinearised(predictions);
  else
    ReceiveSteps(predictions);
}

void LevenbergMarquardt::Continue(int max_iterations, double least_gain) {
  if (!fit_.valid || converged_) return;
  max_iterations_ = max_iterations;
  least_gain_ = least_gain;
  fit_.iterations = 0;
  done_ = false;
}

void LevenbergMarquardt::ReceiveLinearised(const Eigen::Ref<const Eigen::MatrixXd>& predictions) {
  const bool forward = differences_ == Differences::kForward;
  jacobian_ = forward ? ForwardJacobian(problem_, thetas_, predictions, problem_.rows)
                      : CentralJacobian(problem_, thetas_, predictions, problem_.rows);
  if (jacobian_.size() == 0) {
    fit_.valid = false;
    done_ = true;
    return;
  }
  linearises_ = false;
  if (fit_.valid) return;
  fit_.valid = true;
  fit_.prediction = predictions.col(forward ? fit_.theta.size() : 0);
  fit_.cost = problem_.Cost(fit_.theta, fit_.prediction);
  if (max_iterations_ <= 0) End();
}

void LevenbergMarquardt::ReceiveSteps(const Eigen::Ref<const Eigen::MatrixXd>& predictions) {
  Eigen::Index best = -1;
  double best_cost = fit_.cost;
  for (Eigen::Index trial = 0; trial < thetas_.cols(); ++trial) {
    if (!thetas_.col(trial).allFinite() || !std::isfinite(predictions(0, trial))) continue;
    const double cost = problem_.Cost(thetas_.col(trial), predictions.col(trial));
    if (cost < best_cost) {
      best_cost = cost;
      best = trial;
    }
  }
  if (best < 0) {
    converged_ = damping_ > kMaxDamping;
    damping_ *= 1e5;
  } else {
    converged_ = fit_.cost - best_cost < least_gain_;
    damping_ = std::clamp(damping_ * std::pow(kRatio, static_cast<double>(best) - 2.0), 1e-7, kMaxDamping);
    fit_.theta = thetas_.col(best);
    fit_.prediction = predictions.col(best);
    fit_.cost = best_cost;
    linearises_ = true;
  }
  if (converged_)
    End();
  else
    EndIteration();
}

void LevenbergMarquardt::EndIteration() {
  if (++fit_.iterations >= max_iterations_) End();
}

void LevenbergMarquardt::End() {
  fit_.error_sd = std::sqrt(problem_.MeanSquare(fit_.prediction));
  done_ = true;
}

}  // namespace armcmc::identify
