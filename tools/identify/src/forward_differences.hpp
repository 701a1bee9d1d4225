#pragma once

#include <Eigen/Core>
#include <vector>

#include "fit_problem.hpp"

namespace armcmc::identify {

/// Where forward differences at `theta` need predictions: displaced along one parameter each (backward at an upper
/// bound), and `theta` itself last. Half as many as central differences; enough for the steps of a fit.
/// @return [parameter][parameter + 1]
[[nodiscard]] Eigen::MatrixXd Displaced(const FitProblem& problem, const Eigen::VectorXd& theta);

/// Derivatives in units of the spread.
/// @param displaced    From Displaced().
/// @param predictions  [row][parameter + 1] There.
/// @param rows         Whose derivatives are asked for.
/// @return [place in `rows`][parameter]; empty if a prediction is not finite.
[[nodiscard]] Eigen::MatrixXd ForwardJacobian(const FitProblem& problem, const Eigen::MatrixXd& displaced,
                                              const Eigen::Ref<const Eigen::MatrixXd>& predictions,
                                              const std::vector<Eigen::Index>& rows);

}  // namespace armcmc::identify
