#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace armcmc::gap_bench {

/// Effects that are hidden in one kind of plant, by the names of armcmc-plant.
struct Hidden {
  std::string rich;                                             ///< Scenario.
  std::string paper;                                            ///< The same, of the paper; may be empty.
  std::vector<std::string> catalogue;                           ///< By the formulas of the workflow's catalogue.
  std::vector<std::string> variants;                            ///< The same physics by other formulas.
  std::vector<std::string> outside;                             ///< What the catalogue lacks.
  std::map<std::string, std::vector<std::string>> also_called;  ///< Names of the same physics in other catalogues.
  std::vector<std::string> taken_for_granted;  ///< Constants that the tool is told, as lines of `rich`.
};

/// Which effects change what an equation predicts.
struct Felt {
  std::string equation;  ///< As gap::Equation says it.
  std::vector<std::string> only, all_but;
};

/// What cases.toml says.
struct HiddenEffects {
  Hidden contact, actuator;
  std::vector<Felt> felt;

  [[nodiscard]] bool Changes(std::string_view effect, std::string_view equation) const;
};

[[nodiscard]] const HiddenEffects& WhatIsHidden();
[[nodiscard]] inline const Hidden& HiddenInContact() { return WhatIsHidden().contact; }
[[nodiscard]] inline const Hidden& HiddenInActuator() { return WhatIsHidden().actuator; }

}  // namespace armcmc::gap_bench
