#pragma once

// The plants that the benchmark hides effects in, and those whose recorded motions it takes.

#include <array>
#include <vector>

#include "plants/friction_element/motions.hpp"
#include "plants/hunt_crossley/cases.hpp"
#include "plants/indentation/motions.hpp"
#include "plants/servo_axis/motions.hpp"
#include "plants/soft_actuator/cases.hpp"
#include "src/bench_equation.hpp"

namespace armcmc::gap_bench {

/// Of plants that have several.
inline constexpr auto kEquations = kActuatorEquations;

/// Motions of other plants that the contact is driven along.
inline std::vector<RecordedSource> Motions() {
  std::vector<RecordedSource> all;
  for (const auto& motions : {kAxisMotions, kFrictionMotions, kTipMotions})
    all.insert(all.end(), motions.begin(), motions.end());
  return all;
}

}  // namespace armcmc::gap_bench
