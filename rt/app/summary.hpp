#pragma once

#include <string>

#include "armcmc/rt/pipeline.hpp"

namespace armcmc::app {

/// The table at the end of a run. @pre the pipeline has been joined.
[[nodiscard]] std::string SummaryText(const rt::Pipeline& pipeline, const Estimator& estimator);

}  // namespace armcmc::app
