#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "armcmc/gap/result.hpp"
#include "armcmc/ladder/climb.hpp"
#include "armcmc/ladder/tuned.hpp"
#include "armcmc/support/plant_file.hpp"
#include "armcmc/support/recording.hpp"

namespace armcmc::ladder {

/// What is to be diagnosed.
struct DiagnosisRequest {
  support::Recording recording;
  const support::PlantFile* plant = nullptr;
  std::vector<std::string> without;  ///< Effects that are not to be tried.
  std::uint64_t seed = 1;            ///< Of the estimator that goes over the recording.
  std::function<void(const std::string& step, double share)> progress;
};

/// What was found, and the plant with it.
struct Diagnosis {
  gap::Result result;
  Ladder ladder;
  TunedPlant before;  ///< As it came, its priors about the fit.
  TunedPlant after;   ///< With what was named.
};

/// Compares a described plant with a recording, names what is missing, and shows the gap on the rows that the recording
/// keeps apart.
/// @throws support::InputError where there is nothing to compare.
[[nodiscard]] Diagnosis Diagnose(const DiagnosisRequest& request);

}  // namespace armcmc::ladder
