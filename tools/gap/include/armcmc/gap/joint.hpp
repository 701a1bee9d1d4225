#pragma once

#include <string>
#include <vector>

#include "armcmc/gap/diagnose.hpp"

namespace armcmc::gap {

/// Resolves a tie in one recording by a second recording of the same plant.
///
/// Each member of the first recording's set is fitted to the second, with the first posterior of the effect's
/// coordinates phi as prior; the parameters of the law are fitted to each recording separately:
///
///   log p(b | a) = max_theta [ -|w|^2 / (2 s^2) - (phi - phi_a)' P (phi - phi_a) / 2 ] + (log |P| - log |H|) / 2
///
/// The second recording can decide between a few effects even if it is too short or too noisy to find one on its own.
/// The effect must have the same strength in both; an effect that began during the first continues in the second.
///
/// @param first   Must outlive `second`, whose candidates refer to its catalogue.
/// @param second  Diagnosed separately; receives the joint verdict. Unchanged if it names a member of the set, if the
///                first has no tie, or if no member fits it better than the base model.
/// @param notes   Receives the decision.
void Join(const Equation& equation, const Recording& recording, const Diagnosis& first, const Thresholds& thresholds,
          Diagnosis* second, std::vector<std::string>* notes);

}  // namespace armcmc::gap
