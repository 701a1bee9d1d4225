#pragma once

#include <string>

#include "armcmc/rt/pipeline.hpp"

namespace armcmc::app {

/// The table at the end of a run, of one of its plants. `gap_window`: file with the data around a suspected gap. @pre
/// the pipeline has been joined.
[[nodiscard]] std::string SummaryText(const rt::Pipeline& pipeline, const rt::Lane& lane, const Estimator& estimator,
                                      const std::string& gap_window = "");

}  // namespace armcmc::app
