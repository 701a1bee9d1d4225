#pragma once

#include <map>
#include <optional>
#include <string>

#include "armcmc/expression/unit.hpp"

namespace armcmc {

/// The unit that a text such as "output/v^2" stands for, with the units of its names put in: "N/(m/s)^2".
/// @param units  Name -> unit. Names that are not among them are units themselves.
/// @throws expression::Error where that is no unit.
[[nodiscard]] std::string UnitIn(const std::string& text, const std::map<std::string, std::string>& units);

/// The unit, where it is one and can be told.
[[nodiscard]] std::optional<expression::Unit> KnownUnit(const std::string& text);

}  // namespace armcmc
