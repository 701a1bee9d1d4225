#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "armcmc/plant/effect.hpp"

namespace armcmc {

/// As in a file: a law, or modes, never both. Plant() adds the single mode.
[[nodiscard]] PlantDescription AsWritten(PlantDescription plant);

/// The law, or all modes or `predicts`, explain the output itself.
[[nodiscard]] bool ExplainsOutput(const PlantDescription& plant);

/// Modes can become one law: each explains the output, with parameters that are the same in all.
[[nodiscard]] bool MayMerge(const PlantDescription& plant);

/// if(when, law, if(.., .., ..)): the law of the mode that acts, 0 where none does.
[[nodiscard]] std::string MergedLaw(const PlantDescription& plant);

/// A law that is not passive, what it explains, or `predicts` depends on the name: directly, through lets, or through
/// states.
[[nodiscard]] bool LawReads(const PlantDescription& plant, const std::string& name);

/// The text with all lets that it uses, and those that they use, inserted.
[[nodiscard]] std::string WithoutLets(const PlantDescription& plant, std::string text);

/// The rate of a state contains the name, directly or through lets.
[[nodiscard]] bool RateReads(const PlantDescription& plant, const std::string& state, const std::string& name);

/// The texts of the form contain `law` where one law must replace all modes.
[[nodiscard]] bool NeedsOneLaw(const EffectForm& form);

/// Path of a form in a file: "", "form[0]." or "variant[2].".
[[nodiscard]] std::string KeyOfForm(const EffectEntry& entry, std::size_t form);

/// Path of a term's formula within its form: "formula" or "also[0].formula".
[[nodiscard]] std::string KeyOfTerm(std::size_t term);

}  // namespace armcmc
