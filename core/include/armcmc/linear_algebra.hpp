#pragma once

#include <Eigen/Core>

#include "armcmc/types.hpp"

namespace armcmc {

// Bounded sizes live on the stack: no operation on them allocates. Never part of a type that the scoring kernels read:
// Eigen's alignment, and with it the layout, depends on the instruction set that a file is compiled for.
using ParamVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxParams, 1>;
using ParamMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxParams, kMaxParams>;

}  // namespace armcmc
