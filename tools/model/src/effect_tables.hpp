#pragma once

#include <string>
#include <vector>

#include "armcmc/plant/effect.hpp"

namespace armcmc::model {

/// The effects of the catalogue as a table: name, family, what each needs of a plant, what it is.
[[nodiscard]] std::string EffectsText(const std::vector<EffectEntry>& entries);

/// Effects that fit a plant, and why the others do not.
[[nodiscard]] std::string FittingText(const PlantDescription& plant, const std::vector<EffectEntry>& entries);

}  // namespace armcmc::model
