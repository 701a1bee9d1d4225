#include "sealed_file.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "armcmc/plant_sim/effects/gap_meter.hpp"
#include "armcmc/plant_sim/effects/hide.hpp"
#include "armcmc/plant_sim/sha256.hpp"

namespace armcmc::plant_sim {
namespace {

using Json = nlohmann::ordered_json;

Json Describe(const HiddenEffect& effect) {
  Json parameters = Json::object();
  for (std::size_t i = 0; i < effect.values.size(); ++i) {
    const EffectParameter& parameter = effect.spec->parameters[i];
    parameters[parameter.name] = {{"value", effect.values[i]}, {"unit", parameter.unit}};
  }
  return {{"name", effect.spec->name},
          {"variant", effect.spec->variant},
          {"formula_kind", FormulaKindName(effect.spec->kind)},
          {"formula", effect.spec->formula},
          {"gate", effect.gate.Text()},
          {"gap_ratio", effect.gap_ratio},
          {"parameters", parameters}};
}

}  // namespace

std::string WriteSealedFile(const Scenario& scenario, std::uint64_t seed, const std::string& path) {
  Json effects = Json::array(), base = Json::object();
  for (const HiddenEffect& effect : scenario.hidden) effects.push_back(Describe(effect));
  for (std::size_t i = 0; i < scenario.family->parameters.size(); ++i)
    base[scenario.family->parameters[i].name] = scenario.schedule.Value(static_cast<int>(i), 0.0);
  const double gap_ratio = scenario.hidden.empty() ? 0.0 : MakeGapMeter(scenario)->GapRatio(scenario.hidden);
  const Json truth = {{"schema", 1},
                      {"plant", scenario.family->name},
                      {"scenario", scenario.name},
                      {"seed", seed},
                      {"duration_s", scenario.duration_s},
                      {"kind", HiddenKindName(KindOf(scenario.hidden))},
                      {"gap_ratio", gap_ratio},
                      {"base_parameters", base},
                      {"effects", effects}};
  const std::string text = truth.dump(2) + "\n";
  std::ofstream file(path, std::ios::binary);
  file << text << std::flush;
  if (!file) throw std::runtime_error(path + ": cannot be written: " + std::strerror(errno));
  return Sha256(text);
}

}  // namespace armcmc::plant_sim
