#pragma once

#include <set>
#include <string>
#include <vector>

#include "armcmc/ladder/climb.hpp"

namespace armcmc::ladder {

/// Fits everything quickly, what is worth it on all rows, and compares what may be named with the base.
/// @param floor  Standard deviation of the noise: where the quick part shows nothing more, though all rows do, it is
///               all of them.
/// @param notes  Gets why an effect could not be tried.
void TryAll(const std::shared_ptr<const Plant>& plant, const Dataset& data, const View& view, double floor, Rung* rung,
            std::vector<std::string>* notes);

/// A better fit of the model so far than it has, from where effects that explain most have its parameters: what runs
/// freely may be caught far from its best, and every effect that takes part in the search would seem to be missing.
/// @return not valid where there is none.
[[nodiscard]] Trial BetterBase(const std::shared_ptr<const Plant>& plant, const Dataset& data, const Rung& rung);

/// Fills gain_share and win_share from bootstrap samples of the short stretches.
void Bootstrap(Rung* rung);

/// Decides what has earned a name.
/// @param families  That were named before: more of the same is looked for in finer parts.
/// @param before    Share of the error that the rung before leaves, where its name is still open; else 1.
void Judge(const View& view, double floor, const std::set<std::string>& families, double before, Rung* rung);

/// Chooses among those that have earned it and are not ruled out; nothing where there are none.
/// @param open  Also what takes the smaller part only.
void Name(const View& view, double floor, bool open, Rung* rung);

/// Whether one of them lists the other among those that act alike.
[[nodiscard]] bool AreKin(const EffectEntry& a, const EffectEntry& b);

/// Best first.
void Sort(Rung* rung);

}  // namespace armcmc::ladder
