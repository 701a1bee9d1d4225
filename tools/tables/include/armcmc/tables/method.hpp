#pragma once

#include <string>
#include <vector>

#include "armcmc/settings.hpp"

namespace armcmc::tables {

/// One row of a table: a method with its tuning.
struct MethodSpec {
  std::string key;    ///< In tables.json.
  std::string label;  ///< For people.
  EstimatorSettings settings;
  int pack_samples = 100;
  bool online = true;  ///< false: batch least squares, a reference that sees everything so far.
};

/// The methods of the paper for a model, all with the same prior, bounds and noise law. MCMC and batch least squares
/// are for the contact only, as published.
[[nodiscard]] std::vector<MethodSpec> PaperMethods(const EstimatorSettings& base);

/// The settings that a scenario is estimated with: its noise law, given to every method that can use one.
/// @throws std::invalid_argument for an unknown scenario.
[[nodiscard]] EstimatorSettings ScenarioSettings(const std::string& scenario);

}  // namespace armcmc::tables
