#pragma once

#include <fstream>
#include <string>

#include "arguments.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/replay/pack_source.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::replay {

/// What a configuration says to a replay.
struct Session {
  std::string config;  ///< Path of the file; empty: none.
  EstimatorSettings settings;
  double period = 0.1;  ///< s, of a pack; 0: the recording decides.
};

/// @param model  Replaces that of the configuration; empty: does not.
/// @throws support::ConfigError, support::InputError.
[[nodiscard]] Session ReadSession(const std::string& config, const std::string& model,
                                  const std::optional<std::uint64_t>& seed);

/// What to read for an estimator of that session.
[[nodiscard]] SourceRequest RequestFor(const Arguments& arguments, const Session& session, const Estimator& estimator);

/// @throws support::InputError when the file cannot be written.
[[nodiscard]] std::ofstream OpenOutput(const std::string& path);
/// @throws std::runtime_error when not all of it could be written.
void Close(std::ofstream* file, const std::string& path);

}  // namespace armcmc::replay
