#pragma once

#include <Eigen/Core>

#include "armcmc/identify/fit.hpp"
#include "fit_problem.hpp"
#include "shared_runs.hpp"

namespace armcmc::identify {

/// One fit by Levenberg-Marquardt within the bounds, see Fit(). Linearisation and trial steps alternate.
class LevenbergMarquardt : public PredictionUser {
 public:
  /// @param problem     Not copied.
  /// @param start       Clamped to the bounds.
  /// @param least_gain  The fit ends when a step lowers the cost by less.
  LevenbergMarquardt(const FitProblem& problem, const Eigen::VectorXd& start, int max_iterations, double least_gain);

  [[nodiscard]] Eigen::MatrixXd Request() override;
  void Receive(const Eigen::Ref<const Eigen::MatrixXd>& predictions) override;
  /// Complete when done() is true.
  [[nodiscard]] FitResult& result() { return fit_; }

 private:
  void ReceiveLinearised(const Eigen::Ref<const Eigen::MatrixXd>& predictions);
  void ReceiveSteps(const Eigen::Ref<const Eigen::MatrixXd>& predictions);
  void EndIteration();
  void End();

  const FitProblem& problem_;
  const int max_iterations_;
  const double least_gain_;
  FitResult fit_;
  Eigen::MatrixXd thetas_;  ///< Requested, a column each.
  bool linearises_ = true;  ///< Else it tries steps.
  double damping_ = 1e-2, gain_ = 0.0;
};

}  // namespace armcmc::identify
