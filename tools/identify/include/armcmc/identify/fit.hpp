#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "armcmc/identify/trajectory_model.hpp"

namespace armcmc::identify {

/// Where a law fits best.
struct FitResult {
  Eigen::VectorXd theta;       ///< Sampled coordinates.
  Eigen::VectorXd prediction;  ///< [row]
  Eigen::MatrixXd jacobian;    ///< [row][parameter]
  double error_sd = 0.0;       ///< Root mean square of target - prediction over the rows that count.
  double cost = 0.0;           ///< n log(error_sd) + half the squared distance from the prior's mean in its sd.
  int iterations = 0;
  bool valid = false;  ///< The start was finite.
};

/// Maximum a posteriori under Gaussian errors of unknown size, by Levenberg-Marquardt within the bounds:
///
///   minimise n log(s) + 1/2 sum_d ((theta_d - m_d) / sd_d)^2,   s^2 = 1/n sum_rows (target - law)^2
///
/// Parameters with a uniform prior have no pull. Each iteration tries several dampings at once and keeps the best; a
/// parameter at a bound that would leave it stays.
/// @param rows   [row] 1: counts. Only rows where a mode acts do.
/// @param start  Clamped to the bounds.
[[nodiscard]] FitResult Fit(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows,
                            const Eigen::VectorXd& start, int max_iterations = 30);

/// The best of fits by cost, where Fit() begins. All begin with two steps; the `most_fits` best continue, as long as
/// they gain a thousandth of the mean square in an iteration.
/// @param along_one  Starts are first moved along one parameter at a time, the one that helps most: a parameter that
///   is far off is corrected without the others running away.
[[nodiscard]] FitResult BestFit(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows,
                                const std::vector<Eigen::VectorXd>& starts, std::size_t most_fits,
                                int max_iterations = 30, bool along_one = true);

/// Fits that each leave one group of rows out.
struct FitsWithout {
  Eigen::MatrixXd theta;                  ///< [parameter][group]
  Eigen::MatrixXd error;                  ///< [place in `rows`][group] target - prediction, in the group, too.
  std::vector<Eigen::MatrixXd> jacobian;  ///< [group][place in `rows`][parameter] There, or one step before.
};

/// Fits to `rows` without one group at a time: all groups side by side by steps with the Jacobian of the fit to all of
/// them, which the removal of some rows changes little; then Fit for those that it does change.
/// @param all     A valid fit.
/// @param groups  Places in `rows`.
[[nodiscard]] FitsWithout FitWithoutEach(const TrajectoryModel& model, const FitResult& all,
                                         const std::vector<Eigen::Index>& rows,
                                         const std::vector<std::vector<Eigen::Index>>& groups, int max_iterations = 12);

/// Precision of the prior of every sampled parameter; 0 of a uniform one.
[[nodiscard]] Eigen::VectorXd PriorPrecision(const TrajectoryModel& model);

/// Posterior covariance in sampled coordinates at a fit, (J' J / s^2 + prior precision)^-1, with the Jacobian J of the
/// law and the rms error s of the fit.
/// @param rows  [row] 1: fitted.
/// @param fit   A valid fit to these rows.
/// @return [parameter][parameter]
[[nodiscard]] Eigen::MatrixXd Covariance(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows,
                                         const FitResult& fit);

}  // namespace armcmc::identify
