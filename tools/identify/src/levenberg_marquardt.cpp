#include "levenberg_marquardt.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

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

}  // namespace

LevenbergMarquardt::LevenbergMarquardt(const FitProblem& problem, const Eigen::VectorXd& start, int max_iterations,
                                       double least_gain)
    : problem_(problem), max_iterations_(max_iterations), least_gain_(least_gain) {
  fit_.theta = start.cwiseMax(problem.lower).cwiseMin(problem.upper);
  done_ = problem.rows.empty();
}

Eigen::MatrixXd LevenbergMarquardt::Request() {
  thetas_ = linearises_ ? problem_.model.Around(fit_.theta)
                        : Steps(problem_, fit_.theta, NormalEquations(problem_, fit_), Dampings(damping_));
  return thetas_;
}

void LevenbergMarquardt::Receive(const Eigen::Ref<const Eigen::MatrixXd>& predictions) {
  if (linearises_)
    ReceiveLinearised(predictions);
  else
    ReceiveSteps(predictions);
}

void LevenbergMarquardt::ReceiveLinearised(const Eigen::Ref<const Eigen::MatrixXd>& predictions) {
  if (!TrajectoryModel::LineariseFrom(thetas_, predictions, &fit_.prediction, &fit_.jacobian)) {
    fit_.valid = false;
    done_ = true;
    return;
  }
  linearises_ = false;
  if (!fit_.valid) {
    fit_.valid = true;
    fit_.cost = problem_.Cost(fit_.theta, fit_.prediction);
    if (max_iterations_ <= 0) End();
  } else if (gain_ < least_gain_) {
    End();
  } else {
    EndIteration();
  }
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
    if (damping_ > kMaxDamping) {
      End();
    } else {
      damping_ *= 1e5;
      EndIteration();
    }
    return;
  }
  gain_ = fit_.cost - best_cost;
  damping_ = std::clamp(damping_ * std::pow(kRatio, static_cast<double>(best) - 2.0), 1e-7, kMaxDamping);
  fit_.theta = thetas_.col(best);
  fit_.cost = best_cost;
  linearises_ = true;
}

void LevenbergMarquardt::EndIteration() {
  if (++fit_.iterations >= max_iterations_) End();
}

void LevenbergMarquardt::End() {
  fit_.error_sd = std::sqrt(problem_.MeanSquare(fit_.prediction));
  done_ = true;
}

}  // namespace armcmc::identify
