#pragma once

#include <vector>

#include "src/recorded_source.hpp"

namespace armcmc::gap_bench {

/// Strokes against dry friction.
inline const std::vector<RecordedSource> kFrictionMotions = {
    {"friction_damper", "brfd_friction_backlash.csv", "t_s", 1.0, {{"disp_in", 1.0}}, 15.5},
    {"pneumatic_stroke", "pneumatic_seal_friction.csv", "t_ms", 1e-3, {{"position_mm", 1.0}}, 72.0}};

}  // namespace armcmc::gap_bench
