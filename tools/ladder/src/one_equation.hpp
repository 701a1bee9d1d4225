#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "armcmc/ladder/dataset.hpp"
#include "armcmc/ladder/diagnosis.hpp"

namespace armcmc::ladder {

/// Runs the ladder on one equation and fills the result.
/// @param[out] data  The recording, without the rows that depend on unmeasured initial states.
/// @throws support::InputError  if there is nothing to compare.
[[nodiscard]] Diagnosis DiagnoseEquation(const DiagnosisRequest& request, Dataset* data);

/// Fills the result from the ladder.
void Tell(const DiagnosisRequest& request, const Dataset& data, Diagnosis* diagnosis);

/// Adds what the estimator does with the plant before and after: models, drift, predictions.
void FollowUp(const DiagnosisRequest& request, const Dataset& data, Diagnosis* diagnosis);

/// Number of rungs on which something is named.
[[nodiscard]] std::size_t NumNamed(const Ladder& ladder);

[[nodiscard]] std::string JoinedWords(const std::vector<std::string>& words, const char* between);

/// Maps the progress of a part to the interval from `from` to `to` of the whole.
[[nodiscard]] std::function<void(const std::string& step, double share)> PartOf(
    const std::function<void(const std::string& step, double share)>& progress, double from, double to);

}  // namespace armcmc::ladder
