#pragma once

#include <cmath>
#include <string>

namespace armcmc::gap {

/// One parameter in the coordinates of the fit: dimensionless and of order one.
///
///   value = unit_size c           or, for scale-like parameters, value = unit_size exp(c)
///
/// so that one prior serves every plant and every choice of units.
struct Coordinate {
  std::string name;
  std::string unit;
  double lower = -1.0, upper = 1.0;
  double prior_mean = 0.0, prior_sd = 1.0;
  double unit_size = 1.0;
  bool logarithmic = false;
  bool event = false;  ///< The time of an event, or an initial state: only the samples around it determine it,
                       ///< so leaving them out would not test the effect. Scores treat it as known; another recording
                       ///< has its own value.
  bool nuisance = false;  ///< Belongs to a flexible correction, not to a named effect. Scores treat it as known.
  /// At that bound the effect is equivalent to another one (a very slow relaxation is a drift) and not adequate.
  bool other_below = false, other_above = false;

  [[nodiscard]] double Value(double c) const { return unit_size * (logarithmic ? std::exp(c) : c); }
  /// d value / d c.
  [[nodiscard]] double Slope(double c) const { return logarithmic ? Value(c) : unit_size; }
};

}  // namespace armcmc::gap
