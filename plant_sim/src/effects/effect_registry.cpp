#include <algorithm>

#include "armcmc/plant_sim/effects/effect.hpp"

namespace armcmc::plant_sim {

const char* FormulaKindName(FormulaKind kind) noexcept {
  switch (kind) {
    case FormulaKind::kCatalogue: return "catalogue";
    case FormulaKind::kVariant: return "variant";
    case FormulaKind::kOutside: return "outside";
  }
  return "";
}

const std::vector<EffectSpec>& EffectRegistry(const PlantFamily& family) {
  static const std::vector<EffectSpec> none;
  return family.effects != nullptr ? family.effects() : none;
}

const EffectSpec* FindEffectSpec(const PlantFamily& family, const std::string& name, const std::string& variant) {
  for (const EffectSpec& spec : EffectRegistry(family))
    if (spec.name == name && spec.variant == variant) return &spec;
  return nullptr;
}

std::vector<std::string> EffectNames(const PlantFamily& family) {
  std::vector<std::string> names;
  for (const EffectSpec& spec : EffectRegistry(family))
    if (std::find(names.begin(), names.end(), spec.name) == names.end()) names.push_back(spec.name);
  return names;
}

}  // namespace armcmc::plant_sim
