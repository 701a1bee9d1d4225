#pragma once

#include <span>
#include <string>
#include <vector>

#include "armcmc/model.hpp"
#include "armcmc/models/compiled_plant.hpp"
#include "armcmc/settings.hpp"
#include "armcmc/support/strict_toml.hpp"

// The tables that a configuration and a model file have in common.
namespace armcmc::support {

/// What the readers must know of a model besides its settings.
struct ModelFacts {
  const ModelInfo* model = nullptr;  ///< Lives as long as the settings that it was made from.
  std::vector<std::string> modes;
};

[[nodiscard]] ModelFacts FactsOf(const EstimatorSettings& settings);

/// [.K] [.B] ...: prior, mean, sd, lower, upper, each optional.
void ReadParameters(StrictTable parameters, EstimatorSettings* settings);
/// [noise] for every mode, [noise.MODE] for one.
void ReadNoise(StrictTable noise, const std::vector<std::string>& modes, EstimatorSettings* settings);
/// Of a compiled plant; empty: it has none, or its file has them.
[[nodiscard]] std::span<const ConstantInfo> ConstantsOf(const ModelInfo& model);
/// [.constants] of a plant that has some, where `holder` is the table that it is in.
void ReadConstants(StrictTable& holder, const ModelInfo& model, EstimatorSettings* settings);
/// `regress_rate` (or `pressure_rate`, as it is called, too) of a plant that has one, beside its constants.
void ReadRegressRate(StrictTable& holder, const ModelInfo& model, EstimatorSettings* settings);
/// [[effect]]: name, when, from_s or until_s, the shapes as numbers, the priors of the amplitudes as tables. Replaces
/// the effects of the settings when there is one.
void ReadEffects(StrictTable& root, const ModelInfo& model, EstimatorSettings* settings);

}  // namespace armcmc::support
