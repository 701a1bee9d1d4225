#pragma once

#include <string>
#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/equation.hpp"

namespace armcmc::gap {

/// What the inputs of a recording cannot show, whatever its output says.
///
/// For the whitened signature g of an effect (the change of the prediction by a small amplitude of it) and the slopes J
/// of the base law, P the projector on their span, three things are said:
///   - |P g|^2 / |g|^2 > 0.999: the parameters of the law absorb the effect. It cannot be seen, and looks like
///     (J'J)^-1 J' g of them.
///   - g = 0: the effect never acts in this motion.
///   - |cos(g - P g, h - P h)| > 0.98 for the signature h of another effect: the two look alike.
/// An effect with shapes has a signature for each of them: it is absorbed when all are, and looks like another one when
/// any of them does. A wrong gain of the sensor, whose signature is the prediction itself, is judged in the same way.
///
/// @param look  Of a search: its base fit and its catalogue.
[[nodiscard]] std::vector<std::string> Aliases(const Equation& equation, const Look& look);

}  // namespace armcmc::gap
