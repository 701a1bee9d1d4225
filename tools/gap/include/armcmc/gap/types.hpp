#pragma once

#include <Eigen/Core>

namespace armcmc::gap {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

}  // namespace armcmc::gap
