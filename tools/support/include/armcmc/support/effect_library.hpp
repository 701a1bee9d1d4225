#pragma once

#include <string>
#include <vector>

#include "armcmc/plant/effect.hpp"

namespace armcmc::support {

/// The effects that came with the product, which stand in <folder of the program>/../share/armcmc/effects/NAME.toml,
/// by name.
/// @throws ConfigError where one of them is wrong.
[[nodiscard]] std::vector<EffectEntry> ReadEffectLibrary();

/// The entry of that name, or with that name among its aliases.
/// @param where  Begins the message.
/// @throws ConfigError naming the nearest, and all that there are.
[[nodiscard]] const EffectEntry& FindEffect(const std::vector<EffectEntry>& entries, const std::string& name,
                                            const std::string& where);

}  // namespace armcmc::support
