#pragma once

#include <vector>

#include "armcmc/plant_sim/effects/effect.hpp"
#include "armcmc/plant_sim/effects/gate.hpp"

namespace armcmc::plant_sim {

/// An effect at work in a scenario, every parameter decided.
struct HiddenEffect {
  const EffectSpec* spec = nullptr;
  std::vector<double> values;  ///< Order of EffectSpec::parameters.
  Gate gate;
  double gap_ratio = 0.0;  ///< R of this effect alone; see GapMeter.
};

}  // namespace armcmc::plant_sim
