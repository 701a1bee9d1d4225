#pragma once

#include <optional>
#include <string>
#include <vector>

#include "armcmc/ladder/dataset.hpp"
#include "armcmc/plant/description.hpp"

namespace armcmc::ladder {

/// A plant whose modes explain a target has two equations: the law of the target, and `predicts`, which is compared
/// with the measured output. Here each becomes a plant of its own that keeps all names, so that an effect found in one
/// of them can be added to the whole plant unchanged.

/// The law of the target: the plant without `predicts`, and without states, parameters and constants that only
/// `predicts` needs.
[[nodiscard]] PlantDescription LawEquation(const PlantDescription& plant);

/// A state that is replaced by the measured signal at which it starts.
struct MeasuredState {
  std::string state, signal;
};

/// States measured by a signal other than the output: those whose `start` is just that signal, or that name it as
/// `measured_by`, in the same unit.
[[nodiscard]] std::vector<MeasuredState> MeasuredStates(const PlantDescription& plant);

/// The prediction of the output as a plant: its law is `predicts`. It has modes only if a parameter that affects the
/// prediction differs between modes.
///
/// The states in `measured` are replaced by their signals. If they were simulated, every error of the target's law
/// would enter this equation, and accumulate in an integrating state; with the measured signal, the residual of this
/// equation is its own. Noise of the signal is smoothed by the states that follow. If a state starts at the output,
/// which is noisy, its start becomes a parameter NAME_start; so does that of the first state if the prediction depends
/// on no parameter.
///
/// @param scales  Typical sizes of the data.
/// @param noise   Standard deviation of the noise of the output.
/// @return empty if the prediction depends on no parameter and no state, so that there is nothing to fit.
[[nodiscard]] std::optional<PlantDescription> OutputEquation(const PlantDescription& plant,
                                                             const std::vector<MeasuredState>& measured,
                                                             const DataScales& scales, double noise);

}  // namespace armcmc::ladder
