#include "armcmc/stress/stressed_plant.hpp"

#include "armcmc/data_pack_t.hpp"

namespace armcmc::stress {

const StressedPlant& PlantUnderStress() {
  static const StressedPlant plant{
      data_pack_t::PLANT_HUNT_CROSSLEY, "hunt_crossley",
      "[parameters]\nK = 4.0\nB = 2.3\np = 1.7\n[motion]\ntracking = \"prescribed\"\nprogram = \"sine\"\n"
      "depth = 3.0\npace = 1.0\n[noise.f]\n",
      0.1};
  return plant;
}

}  // namespace armcmc::stress
