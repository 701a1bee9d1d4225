#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "armcmc/rt/injection.hpp"
#include "armcmc/rt/settings.hpp"
#include "armcmc/settings.hpp"
#include "gap_log.hpp"

namespace armcmc::app {

/// The command line. What is a list may be given once for every plant.
struct Options {
  std::vector<std::string> config, model, prefix, report, resume;
  std::string lcm_url;
  std::string gap_log;
  std::int64_t steps = 0;
  bool verbose = false;
};

/// What is asked for of one plant.
struct PlantConfiguration {
  EstimatorSettings estimator;
  GapLogSettings gap_log;
  std::string prefix, report, resume;
};

struct Configuration {
  rt::RtSettings rt;
  std::vector<PlantConfiguration> plants;
  std::vector<rt::InjectionItem> inject;
};

/// Reads the files that the options name. --config and --model say how many plants there are: the one that is given
/// more often; the other may be given once, for all of them.
/// @throws support::InputError, support::ConfigError saying what to do.
[[nodiscard]] Configuration Load(const Options& options);

}  // namespace armcmc::app
