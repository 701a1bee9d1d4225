#pragma once

#include <map>
#include <optional>
#include <string>

#include "armcmc/expression/unit.hpp"

namespace armcmc {

/// The unit denoted by a text such as "output/v^2", with the units of its names inserted: "N/(m/s)^2".
/// @param units  Name -> unit. Names that are not among them are units themselves.
/// @throws expression::Error where that is no unit.
[[nodiscard]] std::string UnitIn(const std::string& text, const std::map<std::string, std::string>& units);

/// The unit, if the text is a unit and can be evaluated.
[[nodiscard]] std::optional<expression::Unit> KnownUnit(const std::string& text);

}  // namespace armcmc
