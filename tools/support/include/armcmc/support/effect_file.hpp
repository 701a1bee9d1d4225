#pragma once

#include <filesystem>
#include <string_view>

#include "armcmc/plant/effect.hpp"
#include "armcmc/support/strict_toml.hpp"

namespace armcmc::support {

/// Reads a file of the catalogue of effects.
///
///   schema = 1
///   name, title, family, experiment     words; aliases, kin: arrays of names
///   single = true                       it has a kink: two of them in one place are pieces of a curve, and no name
///   slot, of, formula, explains, online, reason        the usual form (see EffectForm and EffectTerm)
///   also = [{ slot, of, formula }, ..]                 where it acts in more than one place
///   [needs]      NAME = { role, kind, unit, per, reads, rate_of, used }
///   [constants]  NAME = { unit, value }                value: a size, see ScaleValue
///   [let]        NAME = "expression"
///   [states]     NAME = { unit, rate, start, role, substeps }
///   [parameters] NAME = { unit, prior, mean, sd, lower, upper, none }     texts: sizes
///   [[form]]     for plants that the forms before it do not fit: the same keys from slot on
///   [[variant]]  another formula of the same physics: these, name and title; needs that it leaves out are none
///
/// @throws ConfigError with file, line, column, key, and what was expected.
[[nodiscard]] EffectEntry ReadEffect(const std::filesystem::path& path);
/// ReadEffect from text; `name` stands for the file in messages.
[[nodiscard]] EffectEntry EffectFromText(std::string_view text, std::string_view name);
/// An entry in a table of another file, which has no `schema`. The file's Finish() is left to the caller.
[[nodiscard]] EffectEntry EffectFromTable(StrictTable table);

}  // namespace armcmc::support
