#include "sealed_file.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "armcmc/plant_sim/effects/gap_meter.hpp"
#include "armcmc/plant_sim/effects/hide.hpp"
#include "armcmc/support/sha256.hpp"

namespace armcmc::plant_sim {
namespace {

using Json = nlohmann::ordered_json;

Json Describe(const HiddenEffect& effect) {
  Json parameters = Json::object();
  for (std::size_t i = 0; i < effect.values.size(); ++i) {
    const EffectParameter& parameter = effect.spec->parameters[i];
    parameters[parameter.name] = {{"value", effect.values[i]}, {"unit", parameter.unit}};
  }
  const bool from = effect.gate.kind == Gate::Kind::kFrom, until = effect.gate.kind == Gate::Kind::kUntil;
  return {{"name", effect.spec->name},
          {"variant", effect.spec->variant},
          {"formula_kind", FormulaKindName(effect.spec->kind)},
          {"formula", effect.spec->formula},
          {"gate", effect.gate.Text()},
          {"onset_s", from ? Json(effect.gate.at_s) : Json()},
          {"end_s", until ? Json(effect.gate.at_s) : Json()},
          {"gap_ratio", effect.gap_ratio},
          {"parameters", parameters}};
}

Json Describe(const NoiseLaw& law, const std::string& unit) {
  Json json = {{"kind", NoiseKindName(law.kind)}};
  if (law.kind == NoiseKind::kNone) return json;
  json["std"] = law.std;
  json["sd"] = NoiseSd(law);
  json["unit"] = unit;
  json["correlation"] = law.correlation;
  json["growth"] = law.growth;
  if (law.reference > 0.0) json["reference"] = law.reference;
  if (law.kind == NoiseKind::kStudentT) json["dof"] = law.dof;
  if (law.recording) json["recording"] = law.recording->file;
  if (law.kind == NoiseKind::kMixture) {
    json["outlier_weight"] = law.outlier_weight;
    json["outlier_scale"] = law.outlier_scale;
  }
  return json;
}

Json Noise(const Scenario& scenario) {
  Json json = Json::object();
  for (std::size_t i = 0; i < scenario.noise.size(); ++i) {
    const bool input = i < scenario.family->inputs.size();
    const ChannelSpec& channel = input ? scenario.family->inputs[i] : scenario.family->output;
    json[channel.name] = Describe(scenario.noise[i], channel.unit);
  }
  return json;
}

/// Every option of the family by table.
Json OptionValues(const Scenario& scenario) {
  Json json = Json::object();
  for (const OptionSpec& spec : scenario.family->options) {
    Json& at = json[spec.table][spec.key];
    switch (spec.kind) {
      case OptionSpec::Kind::kNumber: at = scenario.options.Number(spec.key); break;
      case OptionSpec::Kind::kList: at = scenario.options.List(spec.key); break;
      case OptionSpec::Kind::kChoice: at = scenario.options.Choice(spec.key); break;
      case OptionSpec::Kind::kSeries:
        if (const auto& series = scenario.options.Recorded(spec.key)) at = series->file;
        break;
    }
  }
  return json;
}

}  // namespace

std::string WriteSealedFile(const Scenario& scenario, std::uint64_t seed, const std::string& path) {
  Json effects = Json::array(), base = Json::object();
  for (const HiddenEffect& effect : scenario.hidden) effects.push_back(Describe(effect));
  for (std::size_t i = 0; i < scenario.family->parameters.size(); ++i)
    base[scenario.family->parameters[i].name] = scenario.schedule.Value(static_cast<int>(i), 0.0);
  double gap_ratio = scenario.hidden.size() == 1 ? scenario.hidden.front().gap_ratio : 0.0;
  if (scenario.hidden.size() > 1) gap_ratio = MakeGapMeter(scenario)->GapRatio(scenario.hidden);
  Json truth = {{"schema", 1},
                {"plant", scenario.family->name},
                {"scenario", scenario.name},
                {"seed", seed},
                {"duration_s", scenario.duration_s},
                {"sample_interval_s", scenario.sample_interval_s},
                {"kind", HiddenKindName(KindOf(scenario.hidden))},
                {"gap_ratio", gap_ratio},
                {"base_parameters", base},
                {"effects", effects},
                {"noise", Noise(scenario)}};
  truth.update(OptionValues(scenario));
  const std::string text = truth.dump(2) + "\n";
  std::ofstream file(path, std::ios::binary);
  file << text << std::flush;
  if (!file) throw std::runtime_error(path + ": cannot be written: " + std::strerror(errno));
  return support::Sha256(text);
}

}  // namespace armcmc::plant_sim
