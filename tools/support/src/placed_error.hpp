#pragma once

#include "armcmc/plant/error.hpp"
#include "armcmc/support/strict_toml.hpp"

namespace armcmc::support {

/// What a plant or an effect says of a key, at the place of the key in its file.
/// @param table  That the key's path begins in.
[[nodiscard]] ConfigError PlacedError(StrictTable table, const PlantError& error);

}  // namespace armcmc::support
