#pragma once

#include <cstddef>

#include "armcmc/linear_algebra.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/parameter_space.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

/// A law that is not linear in its parameters, in a form that recursive least squares accepts: another state z, and
/// what a sample tells about it. All functions: no heap, no lock, no throw.
struct RegressionForm {
  /// Mean and covariance of z by the prior. @param covariance  The identity.
  void (*start)(const ParameterSpace& space, ParamVector* mean, ParamMatrix* covariance) noexcept ARMCMC_NONBLOCKING;
  /// @param noise  Standard deviation of the target. @param[in,out] y  Target less the noise's mean; then what phi' z
  /// explains. @param[in,out] r  Variance of the target; then that of y.
  /// @return false where the sample carries no information about z.
  bool (*row)(const ModeData& data, std::size_t sample, double noise, ParamVector* phi, double* y,
              double* r) noexcept ARMCMC_NONBLOCKING;
  /// Holds z where its parameters are inside their bounds.
  void (*saturate)(const ParameterSpace& space, ParamVector* z) noexcept ARMCMC_NONBLOCKING;
  /// Parameters of the law for a state.
  void (*to_theta)(const ParamVector& z, double* theta) noexcept ARMCMC_NONBLOCKING;
};

}  // namespace armcmc
