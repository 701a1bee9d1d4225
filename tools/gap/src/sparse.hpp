#pragma once

#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/result.hpp"

namespace armcmc::gap {

/// Describes what is missing where no effect of the catalogue explains it: a sum of a few terms of the named variables,
///
///   output = law + sum_k coefficient_k term_k,   term = product of powers, signs and magnitudes, in one mode or
///   always,
///
/// chosen one after the other by what they predict on blocks left out, the base parameters refitted with each, as long
/// as a term closes a share of the gap that the bootstrap holds to be real. A description, not physics.
///
/// @return Terms in the order of their choice; `share` is of the explainable gap, on blocks left out. Empty where no
///         term describes anything.
[[nodiscard]] std::vector<SparseTerm> DescribeSparsely(const Equation& equation, const Diagnosis& diagnosis);

}  // namespace armcmc::gap
