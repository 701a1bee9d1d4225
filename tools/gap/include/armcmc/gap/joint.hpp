#pragma once

#include <string>
#include <vector>

#include "armcmc/gap/diagnose.hpp"

namespace armcmc::gap {

/// Judges what one recording left open by another one of the same plant.
///
/// Each member of the first recording's set is fitted to the second, with the first's posterior of the effect's
/// coordinates phi as prior; the law's own parameters are fitted to each recording by itself:
///
///   log p(b | a) = max_theta [ -|w|^2 / (2 s2) - (phi - phi_a)' P (phi - phi_a) / 2 ] + (log |P| - log |H|) / 2
///
/// An effect too weak to be found in the second recording alone can still tell there which of a few it is. Both
/// recordings must hold it at the same strength; an effect that began during the first goes on in the second.
///
/// @param first   Must outlive `second`, whose candidates refer to its catalogue.
/// @param second  Diagnosed by itself; gets the verdict of both. Stays as it is when it names a member of the set, when
///                the first left nothing open, or when no member fits it better than the model as it is.
/// @param notes   Gets what was decided.
void Join(const Equation& equation, const Recording& recording, const Diagnosis& first, const Thresholds& thresholds,
          Diagnosis* second, std::vector<std::string>* notes);

}  // namespace armcmc::gap
