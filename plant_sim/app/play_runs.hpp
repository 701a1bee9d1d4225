#pragma once

#include <string>

#include "armcmc/plant_sim/sample_runs.hpp"
#include "plant_options.hpp"

namespace armcmc::plant_sim {

/// @throws support::InputError where a stride that is given, not 0, does not divide the samples of a pack.
void CheckStride(int stride, int samples_per_pack);

/// Publishes the samples of a described plant as packs in real time, one run after another, prints what was sent, and
/// writes the log that was asked for. Ends after the last pack, or early and cleanly on SIGINT or SIGTERM.
/// @param title             Stands in what is printed.
/// @param samples_per_pack  In [1, 256].
/// @param speed             > 0; 2: twice as fast as the plant was.
/// @return the exit code.
/// @throws support::InputError where no run fills a pack; std::invalid_argument as DescribedPackBuilder;
///         std::runtime_error when the bus or the log cannot be opened or written.
int PlayRuns(const SampleRuns& runs, const std::string& title, int samples_per_pack, double speed,
             const PlantOptions& options);

}  // namespace armcmc::plant_sim
