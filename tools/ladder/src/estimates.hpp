#pragma once

#include <cstdint>
#include <vector>

#include "armcmc/gap/result.hpp"
#include "armcmc/ladder/trial.hpp"

namespace armcmc::ladder {

/// What a fit says of the parameters, for the report.
struct Estimated {
  std::vector<gap::ParameterEstimate> parameters;  ///< Of a lognormal one the median and its standard deviation.
  std::vector<gap::Combination> determined;
};

/// The parameters of a fitted trial on those rows, with those that these rows do not separate.
[[nodiscard]] Estimated Estimates(const Trial& trial, const std::vector<std::uint8_t>& rows);

}  // namespace armcmc::ladder
