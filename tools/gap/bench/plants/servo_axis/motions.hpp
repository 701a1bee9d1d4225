#pragma once

#include <vector>

#include "src/recorded_source.hpp"

namespace armcmc::gap_bench {

/// Of a linear drive, point to point.
inline const std::vector<RecordedSource> kAxisMotions = {
    {"servo_axis", "emps_estimation.csv", "t_s", 1.0, {{"q_meas_m", 1.0}}, 1e9}};

}  // namespace armcmc::gap_bench
