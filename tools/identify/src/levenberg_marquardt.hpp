#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "armcmc/identify/fit.hpp"
#include "fit_problem.hpp"
#include "shared_runs.hpp"

namespace armcmc::identify {

/// How a fit takes derivatives. Forward differences need half as many predictions; central ones find better minima of
/// laws with kinks, such as those of a play.
enum class Differences : std::uint8_t { kForward, kCentral };

/// One fit by Levenberg-Marquardt within the bounds, see Fit(). Linearisation and trial steps alternate.
class LevenbergMarquardt : public PredictionUser {
 public:
  /// @param problem     Not copied.
  /// @param start       Clamped to the bounds.
  /// @param least_gain  The fit ends when a step lowers the cost by less.
  LevenbergMarquardt(const FitProblem& problem, const Eigen::VectorXd& start, int max_iterations, double least_gain,
                     Differences differences);

  [[nodiscard]] Eigen::MatrixXd Request() override;
  void Receive(const Eigen::Ref<const Eigen::MatrixXd>& predictions) override;
  /// Goes on, for as many iterations again, unless it ended otherwise than by their number.
  void Continue(int max_iterations, double least_gain);
  /// Complete, but for the Jacobian, when done() is true.
  [[nodiscard]] FitResult& result() { return fit_; }

 private:
  void ReceiveLinearised(const Eigen::Ref<const Eigen::MatrixXd>& predictions);
  void ReceiveSteps(const Eigen::Ref<const Eigen::MatrixXd>& predictions);
  void EndIteration();
  void End();

  const FitProblem& problem_;
  int max_iterations_;
  double least_gain_;
  const Differences differences_;
  FitResult fit_;
  Eigen::MatrixXd thetas_;    ///< Requested, a column each.
  Eigen::MatrixXd jacobian_;  ///< [place in problem.rows][parameter] In units of the spread.
  bool linearises_ = true;    ///< Else it tries steps.
  bool converged_ = false;
  double damping_ = 1e-2;
};

}  // namespace armcmc::identify
