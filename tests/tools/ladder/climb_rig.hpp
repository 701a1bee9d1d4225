#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/ladder/climb.hpp"
#include "armcmc/support/effect_library.hpp"
#include "tools/ladder/made_data.hpp"

namespace armcmc::test {

inline double Sign(double x) { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; }

/// Climbs with a part of the catalogue, which takes a second where all of it takes ten.
/// @param kin  Whether effects know which ones act like them.
inline ladder::Ladder ClimbWith(const std::vector<std::string>& effects, const ladder::Dataset& data,
                                PlantDescription plant = AxisPlant(), bool kin = true) {
  ladder::ClimbRequest request;
  request.plant = std::make_shared<const Plant>(std::move(plant));
  for (EffectEntry& entry : support::ReadEffectLibrary())
    if (std::find(effects.begin(), effects.end(), entry.name) != effects.end())
      request.entries.push_back(std::move(entry));
  for (EffectEntry& entry : request.entries)
    if (!kin) entry.kin.clear();
  request.data = data;
  return ladder::Climb(request);
}

inline std::vector<std::string> NamesOf(const ladder::Rung& rung) {
  std::vector<std::string> names;
  for (const std::size_t i : rung.named) names.push_back(rung.contenders[i].candidate.entry->name);
  return names;
}

}  // namespace armcmc::test
