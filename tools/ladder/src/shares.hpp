#pragma once

#include <map>
#include <string>

#include "armcmc/ladder/climb.hpp"

namespace armcmc::ladder {

/// Share of the bootstrap samples in which each effect, by name, explains the data best; their sum is at most 1, and
/// the rest are samples in which none does.
///
/// Formulas of a family win together (Contender::win_share). A family's share is that of its named members, in equal
/// parts, or of its best if none is named. Where the rung names nothing, no effect is the explanation: all are 0.
[[nodiscard]] std::map<std::string, double> SharesOf(const Rung& rung);

}  // namespace armcmc::ladder
