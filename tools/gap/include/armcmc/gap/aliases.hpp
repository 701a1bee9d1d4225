#pragma once

#include <string>
#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/equation.hpp"

namespace armcmc::gap {

/// The effects that the inputs of a recording cannot reveal, independent of its output.
///
/// For the whitened signature g of an effect (the change of the prediction by a small amplitude of it) and the slopes J
/// of the base law, with P the projector on the span of J, there are three cases:
///   - |P g|^2 / |g|^2 > 0.999: the parameters of the law absorb the effect, which then shifts them by
///     (J'J)^-1 J' g.
///   - g = 0: the effect never acts in this motion.
///   - |cos(g - P g, h - P h)| > 0.98 for the signature h of another effect: the two are indistinguishable.
/// An effect with shape parameters has one signature per shape: it is absorbed if all of them are, and
/// indistinguishable from another effect if any of them is. A gain error of the sensor, whose signature is the
/// prediction, is treated alike.
///
/// @param analysis  Provides the base fit and the catalogue.
[[nodiscard]] std::vector<std::string> Aliases(const Equation& equation, const Analysis& analysis);

}  // namespace armcmc::gap
