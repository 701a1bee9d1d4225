#pragma once

#include <string>

#include "armcmc/gap/fit.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::gap {

/// Step four: the settings of an estimator that includes the effects of a fitted hypothesis.
///
/// Priors are the posteriors of the fit, widened so that the estimator can correct them; shapes are constant at their
/// fitted values; the noise is the residual of the fit.
/// @param model    Built-in name of the base.
/// @param noise_sd  Unit of the output.
/// @throws std::invalid_argument when a term is not of the estimator's catalogue, or too many are.
[[nodiscard]] EstimatorSettings AugmentedSettings(const std::string& model, const Fitter& fitter, const Fitted& fitted,
                                                  double noise_sd);

}  // namespace armcmc::gap
