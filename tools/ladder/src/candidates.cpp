#include "armcmc/ladder/candidates.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "armcmc/plant/error.hpp"

namespace armcmc::ladder {

std::vector<Frequency> Candidate::Frequencies() const {
  std::vector<Frequency> frequencies;
  const std::vector<EffectParameter>& parameters = form().parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (parameters[p].prior != "lognormal" || !parameters[p].unit.starts_with("1/")) continue;
    const std::string per = parameters[p].unit.substr(2);
    if (const auto need = binding.symbols.find(per); need != binding.symbols.end())
      frequencies.push_back({first_fitted() + p, need->second});
    else if (per == "s")
      frequencies.push_back({first_fitted() + p, ""});
  }
  return frequencies;
}

std::size_t Candidate::first_fitted() const {
  const auto& modes = plant->modes();
  const auto active = static_cast<std::size_t>(
      std::count_if(modes.begin(), modes.end(), [](const PlantMode& m) { return !m.passive; }));
  std::size_t first = 0;
  for (std::size_t p = 0; p < first_parameter; ++p)
    first += plant->description().parameters[p].per_mode ? std::max<std::size_t>(active, 1) : 1;
  return first;
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

bool SamePlace(const Candidate& a, const Candidate& b) {
  return a.entry == b.entry && a.binding.form == b.binding.form && a.binding.symbols == b.binding.symbols;
}

std::optional<Candidate> SameOn(const PlantDescription& plant, const Candidate& effect, const DataScales& scales) {
  for (const EffectBinding& binding : Bindings(plant, *effect.entry)) {
    if (binding.form != effect.binding.form || binding.symbols != effect.binding.symbols) continue;
    try {
      auto composed = std::make_shared<const Plant>(AddEffect(plant, *effect.entry, binding, scales));
      return Candidate{effect.entry, binding, std::move(composed), plant.parameters.size()};
    } catch (const PlantError&) {  // beyond the limits of a plant
      return std::nullopt;
    }
  }
  return std::nullopt;
}

}  // namespace armcmc::ladder
