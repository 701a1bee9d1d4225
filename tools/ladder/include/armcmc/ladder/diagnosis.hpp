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

/// Input of Diagnose().
struct DiagnosisRequest {
  support::Recording recording;
  const support::PlantFile* plant = nullptr;
  std::vector<std::string> without;  ///< Effects to exclude.
  std::uint64_t seed = 1;            ///< Seed of the estimator that runs over the recording.
  std::string equation;              ///< Name of the equation, if the plant has two; else empty.
  std::function<void(const std::string& step, double share)> progress;
};

/// Output of Diagnose().
struct Diagnosis {
  gap::Result result;
  Ladder ladder;
  TunedPlant before;  ///< The plant without additions, with priors centred on the fit.
  TunedPlant after;   ///< The plant with the named effects.
};

/// Compares a plant file with a recording, names the missing effects, and measures the gap on the held-out rows.
///
/// If the modes of the plant explain a target and it `predicts` the output, both equations are diagnosed separately
/// (see equations.hpp). The result is that of the equation with the gap: the one in which an effect is named, otherwise
/// the one with the larger gap. An error of a sensor that both equations read shows in both, so only what both name is
/// named; if one of them leaves it open, it is tested there at the value found in the other.
/// @throws support::InputError  if there is nothing to compare.
[[nodiscard]] Diagnosis Diagnose(const DiagnosisRequest& request);

}  // namespace armcmc::ladder
