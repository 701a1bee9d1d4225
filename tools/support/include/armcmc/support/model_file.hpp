#pragma once

#include <memory>
#include <string>

#include "armcmc/plant/program.hpp"
#include "armcmc/settings.hpp"
#include "armcmc/support/strict_toml.hpp"

namespace armcmc::support {

// A model file says what a plant is, without saying how the estimator is run:
//
//   schema = 1
//   base = "NAME"                      built-in model
//   [parameters.K]                     priors and bounds of its parameters, as in a configuration
//   [constants]                        of the actuator
//   [noise]  [noise.contact]           as in a configuration
//   [[effect]]                         what is added to it, in any order
//   name = "coulomb_friction"
//   when = "always"                    or "contact", "free"; or from_s = 12.5, or until_s = 12.5
//   speed = 0.02                       shapes are numbers
//   force = { mean = 0.4, sd = 0.1, lower = 0.0, upper = 2.0 }     amplitudes are priors
//
// What a file leaves out keeps the value that it had; an effect starts from the catalogue's priors for forces of 1 N,
// depths of 1 m and speeds of 1 m/s.

/// The plant that `model` is, a plant file or the name of a bundled plant; null where it is a built-in model or
/// a model file, which stands on one.
/// @throws ConfigError where the plant file is wrong.
[[nodiscard]] std::shared_ptr<const PlantProgram> DescribedPlant(const std::string& model);

/// Whether --model means a file: it ends in .toml, or there is such a file.
[[nodiscard]] bool IsModelFile(const std::string& model);

/// The built-in model that `model`, a built-in name or a model file, is or stands on.
/// @throws ConfigError.
[[nodiscard]] std::string BaseModel(const std::string& model);

/// Replaces what the file says: parameters, constants, noise, and all effects when it names any.
/// @pre The settings are of the file's base model.
/// @throws ConfigError naming file, line, key, value and what was expected.
void ApplyModelFile(const std::string& path, EstimatorSettings* settings);

/// BuiltinSettings of the base, then ApplyModelFile; or BuiltinSettings(model) for a built-in name. Valid.
/// @throws ConfigError.
[[nodiscard]] EstimatorSettings ReadModel(const std::string& model);

/// The model file that reads back to the same parameters, constants, noise and effects, exactly.
/// @param base  Built-in name that the settings were made from; empty: settings.model.
[[nodiscard]] std::string ModelFileText(const EstimatorSettings& settings, const std::string& base = {});

}  // namespace armcmc::support
