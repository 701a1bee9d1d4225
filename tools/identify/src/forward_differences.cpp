#include "forward_differences.hpp"

namespace armcmc::identify {

Eigen::MatrixXd Displaced(const FitProblem& problem, const Eigen::VectorXd& theta) {
  constexpr double kStep = 1e-5;  // of the spread
  Eigen::MatrixXd thetas = theta.replicate(1, theta.size() + 1);
  for (Eigen::Index d = 0; d < theta.size(); ++d) {
    const double step = kStep * problem.spread[d];
    thetas(d, d) += theta[d] + step > problem.upper[d] ? -step : step;
  }
  return thetas;
}

Eigen::MatrixXd ForwardJacobian(const FitProblem& problem, const Eigen::MatrixXd& displaced,
                                const Eigen::Ref<const Eigen::MatrixXd>& predictions,
                                const std::vector<Eigen::Index>& rows) {
  if (!predictions.row(0).allFinite()) return {};
  const Eigen::Index size = displaced.rows();
  const Eigen::VectorXd here = predictions.col(size)(rows);
  Eigen::MatrixXd jacobian(here.size(), size);
  for (Eigen::Index d = 0; d < size; ++d)
    jacobian.col(d) = (predictions.col(d)(rows) - here) * (problem.spread[d] / (displaced(d, d) - displaced(d, size)));
  return jacobian;
}

}  // namespace armcmc::identify
