#pragma once

#include <string>
#include <utility>
#include <vector>

#include "case_builder.hpp"

namespace armcmc::gap_bench {

using Fill = void (*)(CaseBuilder*);

/// Strata in which the plant is not the catalogue: laws that differ from their formulas, effects that nobody listed,
/// other formulas, strokes of a press, strong pairs, constants that are a little off.
[[nodiscard]] const std::vector<std::pair<std::string, Fill>>& ImperfectStrata();

}  // namespace armcmc::gap_bench
