#pragma once

#include <vector>

#include "src/recorded_source.hpp"

namespace armcmc::gap_bench {

/// A tip that presses and retracts.
inline const std::vector<RecordedSource> kTipMotions = {
    {"indentation", "afm_indentation_zebrafish.csv", "t_s", 1.0, {{"height_m", -1.0}, {"deflection_m", -1.0}}, 4.8}};

}  // namespace armcmc::gap_bench
