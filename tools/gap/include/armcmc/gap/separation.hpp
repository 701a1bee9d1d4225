#pragma once

#include <string>
#include <vector>

#include "armcmc/gap/result.hpp"
#include "armcmc/gap/types.hpp"

namespace armcmc::gap {

/// A parameter as it was fitted: itself, or its logarithm.
struct FittedParameter {
  std::string name;
  std::string unit;
  double value = 0.0;        ///< Of the parameter, in `unit`.
  bool logarithmic = false;  ///< Row and column of the covariance are of log(value).
};

/// The parameters that a fit does not determine one by one, and what it determines of them.
struct Separation {
  /// [parameter] Names of the others that could make up for a change of it. Empty: it is determined by itself.
  std::vector<std::vector<std::string>> confounded_with;
  std::vector<Combination> combinations;  ///< In the order of the parameters.
};

/// Finds parameters that are confounded, with the covariance C of a fit.
///
/// A parameter is confounded if its standard deviation, sqrt(C_ii), is at least five times that with all others held
/// fixed, 1 / sqrt((C^-1)_ii). The confounded parameters are conditioned on in their order, until the rest P is
/// determined given those, Q:
///
///   combination of i in P:   theta_i - C_iQ C_QQ^-1 theta_Q,   variance   C_ii - C_iQ C_QQ^-1 C_Qi
///
/// which no change of theta_Q along the ridge alters. Coefficients are rounded as far as that leaves the combination
/// determined; value and standard deviation are of the rounded one. Where all its parameters are fitted by logarithms,
/// it is a product of powers; where some are, it is linearised about the fit.
///
/// Only combinations of at most three parameters are reported, and only of an i whose standard deviation is more than
/// half of its value: longer ones say little, and a smaller standard deviation says enough by itself.
///
/// @param parameters  Of one fit.
/// @param covariance  [parameter][parameter] Of the fitted coordinates. Zero where a parameter was held fixed.
/// @return confounded_with has the size of `parameters`. Not finite covariances: nothing is confounded.
[[nodiscard]] Separation Separate(const std::vector<FittedParameter>& parameters, const Matrix& covariance);

}  // namespace armcmc::gap
