#pragma once

#include <optional>
#include <string>
#include <vector>

#include "armcmc/ladder/dataset.hpp"
#include "armcmc/plant/description.hpp"

namespace armcmc::ladder {

/// A plant whose modes explain a target says two things: the law of the target, and `predicts`, which the measured
/// output is compared with. Each is a plant of its own here, with the names of the whole, so that an effect found in
/// one of them fits the whole as it is.

/// The law alone: without `predicts`, and without states, parameters and constants that only it needs.
[[nodiscard]] PlantDescription LawEquation(const PlantDescription& plant);

/// A state that the measured signal it starts from stands for.
struct MeasuredState {
  std::string state, signal;
};

/// States that a signal other than the output measures: those that begin with nothing but that signal, or name it as
/// `measured_by`, with the same unit.
[[nodiscard]] std::vector<MeasuredState> MeasuredStates(const PlantDescription& plant);

/// The prediction of the output: its law is `predicts`, in modes only where a parameter that it feels differs from mode
/// to mode.
///
/// A state in `measured` is the signal itself. Simulated, it would carry every error of the law of the target into this
/// equation, and, where it integrates, more and more of it; measured, what is left in this equation is its own. Noise
/// of the signal is smoothed by the states behind it. Where a state begins with the output, which is measured with
/// noise, its start is a parameter NAME_start; so is that of the first state where the prediction feels no parameter.
///
/// @param scales  Sizes of the data. @param noise  Standard deviation of the output's noise.
/// @return empty where the prediction feels no parameter and has no state: there is nothing to fit.
[[nodiscard]] std::optional<PlantDescription> OutputEquation(const PlantDescription& plant,
                                                             const std::vector<MeasuredState>& measured,
                                                             const DataScales& scales, double noise);

}  // namespace armcmc::ladder
