#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "armcmc/plant/effect.hpp"

namespace armcmc::support {

/// A prior that somebody knows better than the catalogue. What is left out stays.
struct PriorRequest {
  std::optional<double> mean, sd, lower, upper;
};

/// An effect that is to be added to a plant.
struct EffectRequest {
  std::string name;
  std::string variant;                        ///< Empty: the usual form.
  std::map<std::string, std::string> bind;    ///< Need -> symbol, where there is a choice.
  std::map<std::string, PriorRequest> prior;  ///< Parameter, as the entry calls it.
};

/// "linear_loss", "linear_loss:x=high", "overflow:both": a name, then what is to be chosen.
/// @throws ConfigError.
[[nodiscard]] EffectRequest RequestFromWord(const std::string& word);

/// Those of `entries` that were asked for, added one after the other.
/// @param scales  Of data; null: DefaultScales of the plant.
/// @param where   Begins messages.
/// @throws ConfigError where there is no such effect, it does not fit, or it fits in several ways and none was chosen.
[[nodiscard]] PlantDescription WithEffects(PlantDescription plant, const std::vector<EffectEntry>& entries,
                                           const std::vector<EffectRequest>& requests, const DataScales* scales,
                                           const std::string& where);

}  // namespace armcmc::support
