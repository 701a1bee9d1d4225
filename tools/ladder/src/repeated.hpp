#pragma once

#include <string>

#include "armcmc/ladder/climb.hpp"

namespace armcmc::ladder {

/// Why an effect has more than one rung, a sentence for each such effect, with a space before it: its copies act on
/// different quantities, have different formulas, or the first leaves something that a second one explains. Empty if
/// every rung has an effect of its own.
[[nodiscard]] std::string WhyRepeated(const Ladder& ladder);

}  // namespace armcmc::ladder
