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
  std::string equation;              ///< Name of the plant's equation that this is; empty: it has one.
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
///
/// Where the modes of the plant explain a target and it `predicts` the output, both equations are diagnosed, each by
/// itself (see equations.hpp). The result is that of the equation that lacks something: of two the one whose effect has
/// a name, then the one with the larger gap. A sensor that both read shows in both: what both name is what is missing,
/// and where one leaves it open, the other is asked at the value that the first found.
/// @throws support::InputError where there is nothing to compare.
[[nodiscard]] Diagnosis Diagnose(const DiagnosisRequest& request);

}  // namespace armcmc::ladder
