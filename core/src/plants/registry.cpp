#include "plants/registry.hpp"

#include "armcmc/models/registry.hpp"

namespace armcmc {

std::span<const ModelInfo* const> CompiledModels() noexcept { return AllModels::kInfos; }

std::string DefaultModel() { return std::string(AllModels::kInfos.front()->name); }

std::string ModelNames() {
  std::string names;
  for (const ModelInfo* info : AllModels::kInfos) names += (names.empty() ? "" : ", ") + std::string(info->name);
  for (const ModelInfo* info : AllModels::kInfos)
    for (const ModelVariant& variant : info->compiled->variants) names += ", " + std::string(variant.name);
  return names;
}

int FindModel(std::string_view name) noexcept {
  for (int i = 0; i < AllModels::kSize; ++i)
    if (AllModels::kInfos[static_cast<std::size_t>(i)]->name == name) return i;
  return -1;
}

const ModelInfo* ModelOf(PlantNumber number) noexcept {
  for (const ModelInfo* info : AllModels::kInfos)
    if (info->plant == number) return info;
  return nullptr;
}

const EffectInfo* FindEffect(const ModelInfo& model, std::string_view name) noexcept {
  if (model.compiled == nullptr) return nullptr;
  for (const EffectInfo* info : model.compiled->effects)
    if (info->name == name) return info;
  return nullptr;
}

}  // namespace armcmc
