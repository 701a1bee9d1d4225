#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "armcmc/ladder/trial.hpp"

namespace armcmc::ladder {

/// Number of neighbouring samples that share an error: 1 + 2 times the sum of the autocorrelations up to the first
/// negligible one.
[[nodiscard]] double Correlated(const Trial& trial, const std::vector<std::uint8_t>& rows);

/// Posterior standard deviations at a fit, in sampled coordinates, with some of the parameters known: from the inverse
/// of J' J / (f s^2) + prior precision.
class Widths {
 public:
  /// @param rows        [row] 1: used in the fit.
  /// @param correlated  f >= 1, number of neighbouring samples that share an error: see Correlated().
  Widths(const Trial& trial, const std::vector<std::uint8_t>& rows, double correlated = 1.0);

  /// [parameter] Standard deviations; 0 for known parameters.
  [[nodiscard]] Eigen::VectorXd Of(const std::vector<bool>& known) const;

 private:
  Eigen::MatrixXd information_;
};

}  // namespace armcmc::ladder
