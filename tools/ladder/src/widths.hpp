#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "armcmc/ladder/trial.hpp"

namespace armcmc::ladder {

/// How many neighbouring errors say what one says: 1 + 2 sum of the autocorrelations up to the first that is next to
/// nothing.
[[nodiscard]] double Correlated(const Trial& trial, const std::vector<std::uint8_t>& rows);

/// Posterior standard deviations at a fit, in sampled coordinates, with some parameters known: of the inverse of
/// J' J / (f s^2) + prior.
class Widths {
 public:
  /// @param rows        [row] 1: counts.
  /// @param correlated  f: how many neighbouring errors say what one says, >= 1.
  Widths(const Trial& trial, const std::vector<std::uint8_t>& rows, double correlated = 1.0);

  /// [parameter]; 0 where it is known.
  [[nodiscard]] Eigen::VectorXd Of(const std::vector<bool>& known) const;

 private:
  Eigen::MatrixXd information_;
};

}  // namespace armcmc::ladder
