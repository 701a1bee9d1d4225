#include "builtin_scenario.hpp"

#include "scenario_file.hpp"
#include "support/paths.hpp"

namespace armcmc::plant_sim {

Scenario BuiltinScenario(const std::string& name) {
  return LoadScenario(test::SourceDir() / "plant_sim" / "scenarios" / (name + ".toml"));
}

Scenario NoiselessScenario(const std::string& name) {
  Scenario scenario = BuiltinScenario(name);
  for (NoiseLaw& law : scenario.noise) law = {};
  return scenario;
}

}  // namespace armcmc::plant_sim
