#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/gap_bench/case.hpp"

namespace armcmc::gap_bench {

using Names = std::vector<std::string>;  ///< Of the effects of one hypothesis, sorted.

/// Every set of effects that the answer leaves possible: one when it is named, none without a name.
[[nodiscard]] std::vector<Names> SetsOf(const gap::Result& result);
/// Names of the true effects, sorted.
[[nodiscard]] Names NamesOf(const Truth& truth);
/// Families of effects, sorted; a name that the catalogue does not know is a family of its own.
[[nodiscard]] Names FamiliesOf(const Names& names);

/// The sets of an answer: names as in the sealed file, each once, without what the recording holds by itself
/// (Case::own) and nobody hid, and without what is rightly named though it needs no name, since the plant's own
/// catalogue lacks it.
[[nodiscard]] std::vector<Names> ScoredSets(const Case& what, const Truth& truth, const gap::Result& result);

/// Compares an answer with the truth. An effect that is outside the plant's own catalogue, or was taken out of it, is
/// rightly left unnamed, or named as the effects that serve every plant have it; beside one of the catalogue it needs
/// no name.
[[nodiscard]] Grade GradeOf(const Case& what, const Truth& truth, const gap::Result& result);

/// Whether the equation that carries the gap is one that a true effect changes. Nothing where the plant has one
/// equation only, hides nothing of the catalogue, or no gap was found.
[[nodiscard]] std::optional<bool> EquationRight(const Truth& truth, const gap::Result& result);

/// What the tool holds most probable, of: "none", "unnamed", and each set of names ("a + b", summed over formulas and
/// times), with the probability that it prints.
[[nodiscard]] std::pair<std::string, double> TopLabel(const gap::Result& result);
/// Whether that label is true. A relative of the family counts where the catalogue lacks the effect or its formula, and
/// where the plant is not the catalogue.
/// @param model_error  See Outcome::model_error. From the least size of an effect that the tool reckons with, something
///                     is missing that has no name.
[[nodiscard]] bool LabelRight(const Case& what, const Truth& truth, const std::string& label, double model_error = 0.0);

/// Times at which an effect could have begun without the data knowing: between them the effect would have changed the
/// squared output by less than 9 noise variances, 4.5 nats, on either side of the true onset.
/// @param contribution  What the effect adds to the output when it acts always, [row].
[[nodiscard]] std::pair<double, double> OnsetInterval(const std::vector<double>& contribution, double dt,
                                                      double onset_s, double noise_sd);

/// How far the answer's onset is from that interval. Nothing where it names none.
[[nodiscard]] std::optional<double> OnsetError(const gap::Result& result, const std::string& effect,
                                               std::pair<double, double> interval);

}  // namespace armcmc::gap_bench
