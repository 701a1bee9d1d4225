#pragma once

#include <string>
#include <vector>

namespace armcmc::plant_sim {

/// An effect of a model file in terms of the plant's.
struct ModelEffect {
  using Values = std::vector<double>;

  std::string name, variant;
  std::vector<std::string> amplitudes, shapes;  ///< Keys of the file.
  /// Parameters of the plant's effect from amplitudes and shapes; duration of the run in s.
  Values (*values)(const Values& amplitudes, const Values& shapes, double duration_s);

  /// The amplitudes, then the shapes.
  static Values Same(const Values& amplitudes, const Values& shapes, double /*duration_s*/) {
    Values values = amplitudes;
    values.insert(values.end(), shapes.begin(), shapes.end());
    return values;
  }
};

/// What a model file, written for an estimator, says of a family of plants.
struct ModelForm {
  std::vector<std::string> bases;    ///< Names by which such a file calls the family.
  std::vector<std::string> ignored;  ///< Tables that do not concern the plant; with "parameters" it keeps its own.
  std::vector<ModelEffect> effects;
  bool in_this_order = false;  ///< Effects act in the order of that list, not in that of the file.
};

}  // namespace armcmc::plant_sim
