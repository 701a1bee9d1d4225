#pragma once

#include <cstdint>
#include <string>

#include "armcmc/plant_sim/fault_plan.hpp"

namespace armcmc::plant_sim {

/// The command line of armcmc-plant. An empty path means: not asked for.
struct PlantOptions {
  std::uint64_t seed = 1;
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  std::string prefix;
  std::string log_path, csv_path, report_path;
  int stride = 0;  ///< Samples from pack to pack; 0: as many as a pack has, or what the scenario says.
  FaultPlan faults;
};

}  // namespace armcmc::plant_sim
