#pragma once

#include <string>
#include <vector>

#include "armcmc/settings.hpp"

namespace armcmc::calibrate {

/// The text of a configuration with its noise, threshold and rho replaced by those of `settings`: [noise] and every
/// [noise.MODE] anew, forgetting.threshold and forgetting.rho in their table. Everything else stays as it is, comments
/// included.
/// @param mode_names  Of the model, in order.
/// @pre The tables of `text` have headers of their own, as those of all our configurations; the caller reads the result
///      back to be sure.
[[nodiscard]] std::string CalibratedConfig(const std::string& text, const EstimatorSettings& settings,
                                           const std::vector<std::string>& mode_names);

}  // namespace armcmc::calibrate
