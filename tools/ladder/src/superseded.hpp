#pragma once

#include "armcmc/ladder/climb.hpp"

namespace armcmc::ladder {

/// Drops the name before the last one if the last rung names another formula of the same effect, on the same
/// quantities, that explains as much without it: what a sharp friction leaves of a smooth one is a smooth friction, and
/// with that the sharp one has an amplitude that the data do not determine. Then the earlier rung names the new formula
/// and becomes the last one, with a note.
/// @param data  All rows that are fitted.
void DropSuperseded(const Dataset& data, Ladder* ladder);

}  // namespace armcmc::ladder
