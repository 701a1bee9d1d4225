#pragma once

#include <string>

#include "armcmc/plant/description.hpp"

namespace armcmc::support {

/// A plant as the text of a plant file. Reading it gives the same description, numbers to the last bit.
/// @param comment  Lines to stand at the top, without #; empty: none.
[[nodiscard]] std::string PlantFileText(const PlantDescription& plant, const std::string& comment = "");

}  // namespace armcmc::support
