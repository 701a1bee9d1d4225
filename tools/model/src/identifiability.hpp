#pragma once

#include <memory>
#include <string>

#include "armcmc/plant/plant.hpp"
#include "armcmc/support/recording.hpp"

namespace armcmc::model {

/// Which parameters of a plant a recording identifies, as a table and in words: "These data identify M and Fv; not off:
/// it moves against g."
///
/// The law is fitted to the rows that are not held out; standard deviations are those of the inverse of
/// J' J / (s^2 tau) + prior, with J the Jacobian, s the standard deviation of the errors and tau their integrated
/// autocorrelation time in rows. A parameter is identified if its standard deviation is at most a third of the prior's,
/// and if no other parameters compensate it: that is the case if its standard deviation is more than a third of its
/// value, and more than ten times what it would be with the others known.
[[nodiscard]] std::string IdentifiabilityText(const std::shared_ptr<const Plant>& plant,
                                              const support::Recording& recording);

}  // namespace armcmc::model
