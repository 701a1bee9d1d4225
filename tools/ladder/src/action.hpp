#pragma once

#include "armcmc/ladder/candidates.hpp"

namespace armcmc::ladder {

/// Whether what two effects do is a function of one signal, state or time, the same one, in the same equations: curves
/// of another shape, but of one thing.
[[nodiscard]] bool AreCurvesOfOneThing(const Candidate& a, const Candidate& b);

/// Whether an effect depends on a signal or a state, or time where the name is "t".
[[nodiscard]] bool Reads(const Candidate& effect, const std::string& name);

/// Whether it depends on the past: by a state of its own, or a function that remembers.
[[nodiscard]] bool Remembers(const Candidate& effect);

/// Whether it acts on the whole law, and so follows whatever that does.
[[nodiscard]] bool ActsOnLaw(const Candidate& effect);

}  // namespace armcmc::ladder
