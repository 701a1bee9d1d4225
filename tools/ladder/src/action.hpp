#pragma once

#include "armcmc/ladder/candidates.hpp"

namespace armcmc::ladder {

/// Whether two effects are functions of the same signal, state or time, in the same equations; the functions may have
/// different shapes.
[[nodiscard]] bool ActOnSameQuantity(const Candidate& a, const Candidate& b);

/// Whether an effect depends on the signal or state `name`, or, for "t", on time.
[[nodiscard]] bool Reads(const Candidate& effect, const std::string& name);

/// Whether it replaces a signal (slot "input") or a parameter (slot "parameter") of that name.
[[nodiscard]] bool ActsOn(const Candidate& effect, const std::string& slot, const std::string& name);

/// Whether it has memory: a state of its own, or a function such as delay().
[[nodiscard]] bool Remembers(const Candidate& effect);

/// Whether it is added to the output or to a rate, and replaces nothing.
[[nodiscard]] bool Adds(const Candidate& effect);

/// Whether it is added to the output in proportion to the signal or state `name`, with one parameter.
[[nodiscard]] bool IsProportionalTo(const Candidate& effect, const std::string& name);

/// Whether it adds what it remembers, and its states follow linearly what drives them, at a pace of their own: a
/// relaxation, but no dry friction and no oscillation.
[[nodiscard]] bool Relaxes(const Candidate& effect);

/// Whether a name occurs in the formulas of an effect. A parameter that does not occur says only where a state begins.
[[nodiscard]] bool Mentions(const EffectForm& form, const std::string& name);

/// Whether it acts the same wherever the plant is: an offset, or what depends on time alone.
[[nodiscard]] bool IsIndependentOfSignals(const Candidate& effect);

/// Whether it acts on the law as a whole, and so on everything that the law contains.
[[nodiscard]] bool ActsOnLaw(const Candidate& effect);

}  // namespace armcmc::ladder
