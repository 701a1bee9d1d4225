#pragma once

#include <string>
#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/plant_diagnosis.hpp"
#include "armcmc/gap/result.hpp"

namespace armcmc::gap {

/// A finding in the terms of a Result: verdict, effects, candidates, and the sentence that says them.

/// "a, b and c" for words a, b, c with another word between them.
[[nodiscard]] std::string Joined(const std::vector<std::string>& words, const char* between);

/// Each added effect of a hypothesis as a person says it, "adhesion, in contact".
[[nodiscard]] std::vector<std::string> Texts(const CandidatePtr& candidate);

/// Writes verdict, probabilities, effects, candidates and sentence.
/// @param in          " in the flow law" where the plant has several equations, else empty.
/// @param min_active  Blocks of data that an effect must be seen in, or it is provisional.
void Describe(const Diagnosis& diagnosis, const std::string& in, int min_active, Result* result);

/// What the equations other than the carrier lack: named effects join the verdict, anything else is said.
void DescribeOthers(const PlantDiagnosis& plant, int min_active, Result* result);

}  // namespace armcmc::gap
