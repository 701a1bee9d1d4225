#include "armcmc/plant_sim/hunt_crossley_plant.hpp"
#include "armcmc/plant_sim/plant.hpp"
#include "armcmc/plant_sim/soft_actuator_plant.hpp"

namespace armcmc::plant_sim {

const std::vector<const PlantFamily*>& PlantRegistry() {
  static const std::vector<const PlantFamily*> families = {&HuntCrossleyFamily(), &SoftActuatorFamily()};
  return families;
}

const PlantFamily* FindPlantFamily(const std::string& name) {
  for (const PlantFamily* family : PlantRegistry())
    if (family->name == name) return family;
  return nullptr;
}

}  // namespace armcmc::plant_sim
