#pragma once

#include <string>
#include <vector>

#include "armcmc/plant/description.hpp"
#include "armcmc/support/strict_toml.hpp"

namespace armcmc::support {

/// The tables that plant files and effect files have in common.

/// `[let]`: named expressions, in the order of the file.
[[nodiscard]] std::vector<LetDescription> ReadLets(StrictTable* table);

/// One table of `[states]`, without `measured_by`, which only plant files have.
/// @param at  The table `[states.NAME]`.
[[nodiscard]] StateDescription ReadState(StrictTable* at, const std::string& name);

}  // namespace armcmc::support
