#include "armcmc/gap/form_tools.hpp"

#include <cmath>
#include <utility>

namespace armcmc::gap {

Coordinate AmplitudeOf(const char* name, const char* unit, double unit_size, bool has_sign, double sd, double upper) {
  return {name, unit, has_sign ? 0.0 : -upper, upper, 0.0, sd, unit_size, false};
}

Coordinate ShapeOf(const char* name, const char* unit, double unit_size, double lower, double upper) {
  const double low = std::log(lower), high = std::log(upper);
  return {name, unit, low, high, 0.5 * (low + high), 1.0, unit_size, true};
}

void SetStarts(EffectForm* form, const std::vector<int>& counts) {
  std::vector<std::vector<double>> grid{std::vector<double>(static_cast<std::size_t>(form->num_amplitudes), 0.0)};
  for (std::size_t s = 0; s < counts.size(); ++s) {
    const Coordinate& c = form->coordinates[static_cast<std::size_t>(form->num_amplitudes) + s];
    std::vector<std::vector<double>> wider;
    for (const std::vector<double>& start : grid)
      for (int i = 0; i < counts[s]; ++i) {
        wider.push_back(start);
        wider.back().push_back(c.lower + (c.upper - c.lower) * (i + 0.5) / counts[s]);
      }
    grid = std::move(wider);
  }
  form->starts = std::move(grid);
}

EffectForm UnlistedForm(const char* what, const char* family, const char* formula, Slot slot) {
  EffectForm form;
  form.listed = false;
  form.effect = what;
  form.family = family;
  form.formula = formula;
  form.slot = slot;
  return form;
}

}  // namespace armcmc::gap
