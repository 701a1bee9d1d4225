#include "armcmc/plant_sim/schedule.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

namespace armcmc::plant_sim {

Schedule::Schedule(std::vector<double> initial, std::vector<Change> changes)
    : initial_(std::move(initial)), changes_(std::move(changes)) {
  for (const Change& change : changes_) {
    if (change.parameter < 0 || change.parameter >= num_parameters())
      throw std::invalid_argument("change of parameter " + std::to_string(change.parameter) + ": there are only " +
                                  std::to_string(num_parameters()));
    if (!(change.from_s >= 0.0) || !(change.to_s >= change.from_s) || !std::isfinite(change.to_value))
      throw std::invalid_argument("a change must have 0 <= from_s <= to_s and a finite to_value");
  }
  std::stable_sort(changes_.begin(), changes_.end(), [](const Change& a, const Change& b) {
    return std::tie(a.parameter, a.from_s) < std::tie(b.parameter, b.from_s);
  });
  for (std::size_t i = 1; i < changes_.size(); ++i) {
    const Change& before = changes_[i - 1];
    const Change& after = changes_[i];
    if (before.parameter == after.parameter && (after.from_s < before.to_s || after.from_s <= before.from_s))
      throw std::invalid_argument("two changes of one parameter overlap at " + std::to_string(after.from_s) + " s");
  }
}

double Schedule::Value(int parameter, double t_s) const noexcept {
  double value = initial_[static_cast<std::size_t>(parameter)];
  for (const Change& change : changes_) {
    if (change.parameter != parameter) continue;
    if (t_s < change.from_s) break;
    if (t_s >= change.to_s) {
      value = change.to_value;
      continue;
    }
    const double share = (t_s - change.from_s) / (change.to_s - change.from_s);
    return value + share * (change.to_value - value);
  }
  return value;
}

}  // namespace armcmc::plant_sim
