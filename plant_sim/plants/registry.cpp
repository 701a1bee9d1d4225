// The families of plants that are compiled in: the one place that lists them.

#include "armcmc/plant_sim/plant.hpp"
#include "hunt_crossley/plant.hpp"
#include "soft_actuator/plant.hpp"

namespace armcmc::plant_sim {

const std::vector<const PlantFamily*>& PlantRegistry() {
  static const std::vector<const PlantFamily*> families = {&HuntCrossleyFamily(), &SoftActuatorFamily()};
  return families;
}

std::string DefaultScenario() { return HuntCrossleyFamily().name + "_paper"; }

const PlantFamily* FindPlantFamily(const std::string& name) {
  for (const PlantFamily* family : PlantRegistry())
    if (family->name == name) return family;
  return nullptr;
}

}  // namespace armcmc::plant_sim
