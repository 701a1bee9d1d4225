#pragma once

#include <string>

#include "armcmc/settings.hpp"
#include "armcmc/support/strict_toml.hpp"

namespace armcmc::support {

/// Reads what decides the estimates: schema, [model], [noise], [forgetting], [sampler].
///
/// Starts from BuiltinSettings(name) and replaces what the file sets, key by key; the keys are those of
/// settings.hpp. [noise] holds for every mode, [noise.MODE] for one. The other tables of the file are the
/// caller's; root.Finish() is the caller's too.
/// @param model_override  Built-in name that replaces model.name of the file; empty: the file decides.
/// @throws ConfigError naming file, line, key, value and what was expected.
[[nodiscard]] EstimatorSettings ReadEstimatorSettings(StrictTable& root, const std::string& model_override);

}  // namespace armcmc::support
