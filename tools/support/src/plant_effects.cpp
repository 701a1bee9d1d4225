#include "armcmc/support/plant_effects.hpp"

#include <algorithm>
#include <limits>

#include "armcmc/support/effect_file.hpp"
#include "armcmc/support/effect_library.hpp"

namespace armcmc::support {
namespace {

PriorRequest ReadPrior(StrictTable table) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  PriorRequest prior;
  for (const auto& [key, value] : {std::pair{"mean", &prior.mean}, std::pair{"sd", &prior.sd},
                                   std::pair{"lower", &prior.lower}, std::pair{"upper", &prior.upper}})
    if (table.Has(key)) *value = table.RequiredNumber(key, -kInf, kInf);
  return prior;
}

EffectRequest ReadRequest(StrictTable table) {
  EffectRequest request;
  request.name = table.RequiredText("name");
  request.variant = table.Text("variant", "");
  StrictTable bind = table.Table("bind");
  for (const std::string& need : bind.Keys()) request.bind[need] = bind.RequiredText(need);
  for (const std::string& key : table.Keys())
    if (key != "name" && key != "variant" && key != "bind") request.prior[key] = ReadPrior(table.Table(key));
  return request;
}

}  // namespace

PlantEffects ReadPlantEffects(StrictTable root) {
  PlantEffects effects;
  for (StrictTable& at : root.Tables("effect")) {
    effects.own.push_back(EffectFromTable(at));
    for (std::size_t other = 0; other + 1 < effects.own.size(); ++other)
      if (effects.own[other].name == effects.own.back().name) throw at.Error("name", "two effects are called so");
  }
  StrictTable table = root.Table("effects");
  for (const StrictTable::TextOrTable& item : table.TextsOrTables("use"))
    effects.use.push_back(item.text.empty() ? ReadRequest(item.table) : RequestFromWord(item.text));
  effects.without = table.Texts("without");
  if (effects.use.empty() && effects.without.empty()) return effects;
  // A name that nothing has would say nothing.
  const std::vector<EffectEntry> known = EffectsFor(effects);
  try {
    for (const std::string& name : effects.without) (void)FindEffect(known, name, "");
  } catch (const ConfigError& error) {
    throw table.Error("without", error.what());
  }
  return effects;
}

std::vector<EffectEntry> EffectsFor(const PlantEffects& effects) {
  std::vector<EffectEntry> all = effects.own;
  for (EffectEntry& entry : ReadEffectLibrary()) {
    const bool replaced =
        std::any_of(effects.own.begin(), effects.own.end(), [&](const auto& own) { return own.name == entry.name; });
    if (!replaced) all.push_back(std::move(entry));
  }
  return all;
}

}  // namespace armcmc::support
