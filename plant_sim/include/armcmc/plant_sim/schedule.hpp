#pragma once

#include <vector>

namespace armcmc::plant_sim {

/// One change of a parameter: a step when from_s == to_s, else a linear drift that ends at to_value.
struct Change {
  int parameter = 0;      ///< Index into the family's parameters.
  double from_s = 0.0;    ///< s, plant time at which the change begins.
  double to_s = 0.0;      ///< s, plant time at which to_value is reached, >= from_s.
  double to_value = 0.0;  ///< Value from then on.
};

/// The true parameters as functions of plant time. Const after construction; reading it has no state.
class Schedule {
 public:
  /// @throws std::invalid_argument when a change names no parameter, ends before it begins, or overlaps
  ///         another change of the same parameter.
  Schedule(std::vector<double> initial, std::vector<Change> changes);

  /// Value of a parameter at plant time t_s. A step at t holds from t on, t included.
  [[nodiscard]] double Value(int parameter, double t_s) const noexcept;
  [[nodiscard]] int num_parameters() const noexcept { return static_cast<int>(initial_.size()); }
  [[nodiscard]] const std::vector<Change>& changes() const noexcept { return changes_; }

 private:
  std::vector<double> initial_;
  std::vector<Change> changes_;  ///< By parameter, then by time.
};

}  // namespace armcmc::plant_sim
