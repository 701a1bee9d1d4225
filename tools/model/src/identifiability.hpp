#pragma once

#include <memory>
#include <string>

#include "armcmc/plant/plant.hpp"
#include "armcmc/support/recording.hpp"

namespace armcmc::model {

/// Which parameters of a plant a recording tells, as a table and in words: "these data tell M and Fv; not off: it moves
/// against g".
///
/// The law is fitted to the rows that are not kept apart; standard deviations are those of the inverse of
/// J' J / (s^2 tau) + prior, tau the number of rows after which errors are independent. A parameter is told when that
/// is a third of its prior's or less, and others do not make up for it: when they were known it would not be ten times
/// less while it is more than a third of the value.
[[nodiscard]] std::string IdentifiabilityText(const std::shared_ptr<const Plant>& plant,
                                              const support::Recording& recording);

}  // namespace armcmc::model
