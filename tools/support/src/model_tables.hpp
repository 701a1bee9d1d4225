#pragma once

#include <string>
#include <vector>

#include "armcmc/data_pack.hpp"
#include "armcmc/settings.hpp"
#include "armcmc/support/strict_toml.hpp"

// The tables that a configuration and a model file have in common.
namespace armcmc::support {

/// What the readers must know of a model besides its settings.
struct ModelFacts {
  PlantKind plant{};
  std::vector<std::string> modes;
};

[[nodiscard]] ModelFacts FactsOf(const EstimatorSettings& settings);

/// [.K] [.B] ...: prior, mean, sd, lower, upper, each optional.
void ReadParameters(StrictTable parameters, EstimatorSettings* settings);
/// [noise] for every mode, [noise.MODE] for one.
void ReadNoise(StrictTable noise, const std::vector<std::string>& modes, EstimatorSettings* settings);
/// [.constants] of the actuator, where `holder` is the table that it is in.
void ReadConstants(StrictTable& holder, PlantKind plant, EstimatorSettings* settings);
/// `pressure_rate` of the actuator, beside its constants.
void ReadPressureRate(StrictTable& holder, PlantKind plant, EstimatorSettings* settings);
/// [[effect]]: name, when, from_s or until_s, the shapes as numbers, the priors of the amplitudes as tables. Replaces
/// the effects of the settings when there is one.
void ReadEffects(StrictTable& root, PlantKind plant, EstimatorSettings* settings);

}  // namespace armcmc::support
