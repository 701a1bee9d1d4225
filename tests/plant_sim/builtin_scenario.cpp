#include "builtin_scenario.hpp"

#include "scenario_file.hpp"
#include "support/paths.hpp"

namespace armcmc::plant_sim {

Scenario BuiltinScenario(const std::string& name) {
  return LoadScenario(test::SourceDir() / "plant_sim" / "scenarios" / (name + ".toml"));
}

}  // namespace armcmc::plant_sim
