#pragma once

#include "armcmc/plots/page.hpp"
#include "armcmc/tables/experiment.hpp"

namespace armcmc::tables {

/// The paper's figures of an experiment: posterior density over time, point estimates, force error or angle.
void AddFigures(const Experiment& experiment, plots::Page* page);

/// k_min over lambda for the paper's epsilon and delta.
void AddDrawNumbers(plots::Page* page);

}  // namespace armcmc::tables
