#include "armcmc/support/median_step.hpp"

#include <algorithm>
#include <cstddef>

namespace armcmc::support {

double MedianStep(const std::vector<double>& t) {
  std::vector<double> steps(t.size() - 1);
  for (std::size_t n = 0; n < steps.size(); ++n) steps[n] = t[n + 1] - t[n];
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

}  // namespace armcmc::support
