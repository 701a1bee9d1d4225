#include "armcmc/ladder/candidates.hpp"

#include <set>

#include "armcmc/plant/error.hpp"

namespace armcmc::ladder {

std::vector<Candidate> Candidates(const PlantDescription& plant, const std::vector<EffectEntry>& entries,
                                  const DataScales& scales, std::vector<std::string>* notes) {
  std::vector<Candidate> candidates;
  std::set<std::string> noted;
  for (const EffectEntry& entry : entries)
    for (const EffectBinding& binding : Bindings(plant, entry)) {
      try {
        auto composed = std::make_shared<const Plant>(AddEffect(plant, entry, binding, scales));
        candidates.push_back({&entry, binding, std::move(composed), plant.parameters.size()});
      } catch (const PlantError& error) {
        if (noted.insert(entry.name).second) notes->push_back(entry.name + " was not tried: " + error.what());
      }
    }
  return candidates;
}

}  // namespace armcmc::ladder
