#pragma once

#include <cmath>
#include <string>

namespace armcmc::gap {

/// One parameter as the fit moves it: free of units, of order one.
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
  bool event = false;  ///< A time at which something happens, or a state at the start: only the samples around it know
                       ///< it, and leaving them out would say nothing on the effect. Scores take it as known; another
                       ///< recording has its own.
  bool nuisance = false;  ///< Of physics that is granted, not claimed. Scores take it as known.
  /// Resting on that bound, the effect has become another one (a very slow relaxation is a drift): it is not adequate.
  bool other_below = false, other_above = false;

  [[nodiscard]] double Value(double c) const { return unit_size * (logarithmic ? std::exp(c) : c); }
  /// d value / d c.
  [[nodiscard]] double Slope(double c) const { return logarithmic ? Value(c) : unit_size; }
};

}  // namespace armcmc::gap
