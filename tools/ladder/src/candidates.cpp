#include "armcmc/ladder/candidates.hpp"

#include <set>

#include "armcmc/plant/error.hpp"

namespace armcmc::ladder {

std::vector<Frequency> Candidate::Frequencies() const {
  std::vector<Frequency> frequencies;
  const std::vector<EffectParameter>& parameters = form().parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (parameters[p].prior != "lognormal" || !parameters[p].unit.starts_with("1/")) continue;
    const std::string per = parameters[p].unit.substr(2);
    if (const auto need = binding.symbols.find(per); need != binding.symbols.end())
      frequencies.push_back({first_parameter + p, need->second});
    else if (per == "s")
      frequencies.push_back({first_parameter + p, ""});
  }
  return frequencies;
}

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
