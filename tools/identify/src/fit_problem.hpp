#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "armcmc/identify/fit.hpp"
#include "armcmc/identify/trajectory_model.hpp"

namespace armcmc::identify {

/// What a fit minimises: n log(s) + 1/2 sum_d (theta_d - mean_d)^2 precision_d, see Fit().
struct FitProblem {
  const TrajectoryModel& model;
  std::vector<Eigen::Index> rows;   ///< Those that count.
  Eigen::VectorXd lower, upper;     ///< [parameter]
  Eigen::VectorXd mean, precision;  ///< [parameter] Of the prior.
  Eigen::VectorXd spread;           ///< [parameter] Unit of the steps.

  [[nodiscard]] double Cost(const Eigen::VectorXd& theta, const Eigen::VectorXd& prediction) const;
  /// Mean square of target - prediction over `rows`.
  [[nodiscard]] double MeanSquare(const Eigen::VectorXd& prediction) const;
};

/// @param rows  [row] 1: counts, where a mode acts.
[[nodiscard]] FitProblem MakeFitProblem(const TrajectoryModel& model, const std::vector<std::uint8_t>& rows);

/// The rows that are marked and where a mode acts.
[[nodiscard]] std::vector<Eigen::Index> CountedRows(const TrajectoryModel& model,
                                                    const std::vector<std::uint8_t>& rows);

/// Normal equations in units of the prior's spread, because parameters differ in magnitude.
struct NormalSystem {
  Eigen::MatrixXd matrix;  ///< [parameter][parameter]
  Eigen::VectorXd right;   ///< [parameter]
};

/// Weights J' J and J' e by the precision of the errors, and adds the prior.
/// @param theta    Where they were taken.
/// @param squares  Sum of squared errors.
/// @param count    Number of rows.
/// @param normal   J' J and J' e in units of the spread.
void AddPrior(const FitProblem& problem, const Eigen::VectorXd& theta, double squares, Eigen::Index count,
              NormalSystem* normal);

/// Parameters after a step with each of these dampings, within the bounds.
/// @return [parameter][damping]
[[nodiscard]] Eigen::MatrixXd Steps(const FitProblem& problem, const Eigen::VectorXd& theta, const NormalSystem& normal,
                                    const std::vector<double>& dampings);

}  // namespace armcmc::identify
