#pragma once

#include <set>
#include <string>
#include <vector>

#include "armcmc/ladder/climb.hpp"

namespace armcmc::ladder {

/// Fits all candidates to a subset, refits the promising ones to all rows, and compares those that may be named with
/// the base model.
/// @param floor  Standard deviation of the noise. If only noise remains on the subset but not on all rows, all rows are
///   used.
/// @param above_tie  If the rung is above a tie, the families named before: an effect of another one has to remove the
///   larger part there, and what comes nowhere near is not refitted. Null: a smaller part may be named.
/// @param notes      Receives the reason if an effect could not be tried.
void TryAll(const std::shared_ptr<const Plant>& plant, const Dataset& data, const View& view, double floor,
            const std::set<std::string>* above_tie, Rung* rung, std::vector<std::string>* notes);

/// A better fit of the base model, started from the parameters that it has in the best contenders. A simulated plant
/// may be stuck far from its optimum; every effect that helps it out would then seem to be missing.
/// @return an invalid trial if there is none.
[[nodiscard]] Trial BetterBase(const std::shared_ptr<const Plant>& plant, const Dataset& data, const Rung& rung);

/// Sets gain_share and win_share, by a bootstrap over the short segments.
void Bootstrap(Rung* rung);

/// Applies rule 1 of Climb() to every contender.
/// @param families  Families named before, in which smaller effects may follow.
/// @param before    Share of the error that the previous rung leaves, if its name is still open; otherwise 1.
void Judge(const View& view, double floor, const std::set<std::string>& families, double before, Rung* rung);

/// Rules out a contender, and with it those that are the same with more parameters or more signals: a Stribeck friction
/// without a peak is the dry friction that a rival explains.
void RuleOut(const View& view, std::size_t which, Rung* rung);

/// Applies rules 2 and 3 of Climb() to the contenders that passed rule 1 and are not ruled out; names nothing if there
/// are none.
/// @param open  Also accept effects that remove less than half of the error.
void Name(const View& view, double floor, bool open, Rung* rung);

/// The contenders that the best one of them does not exclude by rule 3 of Climb(): its kin, and families that win one
/// bootstrap sample in twenty; the best first. All have to be judged.
[[nodiscard]] std::vector<std::size_t> StillTied(const Rung& rung);

/// Whether one of them lists the other as `kin`.
[[nodiscard]] bool AreKin(const EffectEntry& a, const EffectEntry& b);

/// Sorts the contenders, best first.
void Sort(Rung* rung);

}  // namespace armcmc::ladder
