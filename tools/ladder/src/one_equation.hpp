#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "armcmc/ladder/dataset.hpp"
#include "armcmc/ladder/diagnosis.hpp"

namespace armcmc::ladder {

/// Climbs, and tells what was found. @param[out] data  The recording, without rows that unknown starts decide.
/// @throws support::InputError where there is nothing to compare.
[[nodiscard]] Diagnosis DiagnoseEquation(const DiagnosisRequest& request, Dataset* data);

/// Fills the result, for people and for programs, from the ladder.
void Tell(const DiagnosisRequest& request, const Dataset& data, Diagnosis* diagnosis);

/// What the estimator makes of the plant before and after: models, drift, predictions.
void FollowUp(const DiagnosisRequest& request, const Dataset& data, Diagnosis* diagnosis);

/// Rungs that name something.
[[nodiscard]] std::size_t NumNamed(const Ladder& ladder);

[[nodiscard]] std::string JoinedWords(const std::vector<std::string>& words, const char* between);

/// Progress from `from` to `to` of the whole.
[[nodiscard]] std::function<void(const std::string& step, double share)> PartOf(
    const std::function<void(const std::string& step, double share)>& progress, double from, double to);

}  // namespace armcmc::ladder
