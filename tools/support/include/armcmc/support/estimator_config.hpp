#pragma once

#include <string>

#include "armcmc/settings.hpp"
#include "armcmc/support/strict_toml.hpp"

namespace armcmc::support {

/// Reads what decides the estimates: schema, [model], [noise], [[effect]], [forgetting], [sampler], [gap_watch].
///
/// Starts from BuiltinSettings(name) and replaces what the file sets, key by key; the keys are those of
/// settings.hpp. [noise] holds for every mode, [noise.MODE] for one. The other tables of the file are the
/// caller's; root.Finish() is the caller's too.
/// @param model_override  Built-in name that replaces model.name of the file; or a model file (model_file.hpp), whose
///                        parameters, noise and effects replace those of the configuration; or a plant, by file or by
///                        name (DescribedPlant), of which the configuration sets the noise only; empty: the file
///                        decides.
/// @throws ConfigError naming file, line, key, value and what was expected.
[[nodiscard]] EstimatorSettings ReadEstimatorSettings(StrictTable& root, const std::string& model_override);

}  // namespace armcmc::support
