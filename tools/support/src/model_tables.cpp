#include "model_tables.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/models/registry.hpp"
#include "armcmc/plant/program.hpp"
#include "read_word.hpp"

namespace armcmc::support {
namespace {

void ReadPrior(StrictTable table, ParameterSettings* prior) {
  ParameterSettings& p = *prior;
  p.prior =
      ReadWord<PriorKind>(table, "prior", p.prior, {{"normal", PriorKind::kNormal}, {"uniform", PriorKind::kUniform}});
  p.mean = table.Number("mean", p.mean, -kMax, kMax);
  p.sd = table.Number("sd", p.sd, kTiny, kMax);
  p.lower = table.Number("lower", p.lower, -kMax, kMax);
  p.upper = table.Number("upper", p.upper, -kMax, kMax);
  if (!(p.lower < p.upper))
    throw table.Error(
        table.Has("upper") ? "upper" : "lower",
        "expected lower < upper, they are " + std::to_string(p.lower) + " and " + std::to_string(p.upper));
  if (p.prior == PriorKind::kUniform)
    for (const char* key : {"mean", "sd"})
      if (table.Has(key))
        throw table.Error(key, "a uniform prior has bounds only; remove this key or use prior = \"normal\"");
}

void ReadNoiseLaw(StrictTable& table, NoiseSettings* noise) {
  noise->kind = ReadWord<NoiseKind>(table, "kind", noise->kind,
                                    {{"gaussian", NoiseKind::kGaussian},
                                     {"student_t", NoiseKind::kStudentT},
                                     {"laplace", NoiseKind::kLaplace},
                                     {"mixture", NoiseKind::kMixture}});
  noise->std = table.Number("std", noise->std, kTiny, kMax);
  noise->mean = table.Number("mean", noise->mean, -kMax, kMax);
  noise->estimate_std = table.Boolean("estimate_std", noise->estimate_std);
  noise->std_log_sd = table.Number("std_log_sd", noise->std_log_sd, kTiny, kMax);
  noise->dof = table.Number("dof", noise->dof, kTiny, kMax);
  noise->outlier_weight = table.Number("outlier_weight", noise->outlier_weight, kTiny, 0.5);
  noise->outlier_scale = table.Number("outlier_scale", noise->outlier_scale, std::nextafter(1.0, 2.0), kMax);
}

void ReadEffect(StrictTable& table, const ModelInfo& model, EffectSettings* effect) {
  const EffectInfo& info = *FindEffect(model, effect->name);
  effect->gate = ReadWord<EffectGate>(
      table, "when", effect->gate,
      {{"always", EffectGate::kAlways}, {"contact", EffectGate::kContact}, {"free", EffectGate::kFree}});
  const int gates = table.Has("when") + table.Has("from_s") + table.Has("until_s");
  if (gates > 1)
    throw table.Error(table.Has("from_s") ? "from_s" : "until_s",
                      "an effect has `when`, `from_s` or `until_s`, not both");
  if (table.Has("from_s")) {
    effect->gate = EffectGate::kFrom;
    effect->from_s = table.Number("from_s", 0.0, -kMax, kMax);
  }
  if (table.Has("until_s")) {
    effect->gate = EffectGate::kUntil;
    effect->until_s = table.Number("until_s", 0.0, -kMax, kMax);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(info.num_shapes); ++i) {
    const EffectShape& shape = info.shapes[i];
    effect->shapes[i] = table.Number(shape.name, effect->shapes[i], shape.lower, shape.upper);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(info.num_amplitudes); ++i)
    ReadPrior(table.Table(info.amplitudes[i].name), &effect->amplitudes[i]);
}

}  // namespace

ModelFacts FactsOf(const EstimatorSettings& settings) {
  const ModelInfo& info = settings.plant != nullptr
                              ? settings.plant->info()
                              : *CompiledModels()[static_cast<std::size_t>(FindModel(settings.model))];
  ModelFacts facts{.model = &info, .modes = {}};
  for (int mode = 0; mode < info.num_modes; ++mode)
    facts.modes.emplace_back(info.modes[static_cast<std::size_t>(mode)]);
  return facts;
}

void ReadParameters(StrictTable parameters, EstimatorSettings* settings) {
  for (int i = 0; i < settings->num_parameters; ++i) {
    ParameterSettings& p = settings->parameters[static_cast<std::size_t>(i)];
    ReadPrior(parameters.Table(p.name), &p);
  }
}

void ReadNoise(StrictTable noise, const std::vector<std::string>& modes, EstimatorSettings* settings) {
  for (std::size_t mode = 0; mode < modes.size(); ++mode) {
    ReadNoiseLaw(noise, &settings->noise[mode]);
    StrictTable one = noise.Table(modes[mode]);
    ReadNoiseLaw(one, &settings->noise[mode]);
  }
}

std::span<const ConstantInfo> ConstantsOf(const ModelInfo& model) {
  return model.compiled != nullptr ? model.compiled->constants : std::span<const ConstantInfo>();
}

void ReadConstants(StrictTable& holder, const ModelInfo& model, EstimatorSettings* settings) {
  const std::span<const ConstantInfo> constants = ConstantsOf(model);
  if (constants.empty()) {
    if (holder.Has("constants")) throw holder.Error("constants", settings->model + " has no constants");
    return;
  }
  StrictTable table = holder.Table("constants");
  std::string known;
  for (std::size_t i = 0; i < constants.size(); ++i) {
    const ConstantInfo& c = constants[i];
    settings->constants[i] = table.Number(c.name, settings->constants[i], c.least, c.most);
    known += (known.empty() ? "" : ", ") + std::string(c.name);
  }
  for (const std::string& key : table.Keys())
    if (std::none_of(constants.begin(), constants.end(), [&](const ConstantInfo& c) { return c.name == key; }))
      throw table.Error(key, settings->model + " has no such constant; it has " + known);
}

void ReadRegressRate(StrictTable& holder, const ModelInfo& model, EstimatorSettings* settings) {
  const std::string_view key = holder.Has("pressure_rate") ? "pressure_rate" : "regress_rate";
  if (key == "pressure_rate" && holder.Has("regress_rate"))
    throw holder.Error("pressure_rate", "means the same as regress_rate; remove one");
  if ((model.compiled == nullptr || model.compiled->rate_unit.empty()) && holder.Has(key))
    throw holder.Error(key, settings->model + " has no rate to regress");
  settings->regress_rate = holder.Boolean(key, settings->regress_rate);
}

void ReadEffects(StrictTable& root, const ModelInfo& model, EstimatorSettings* settings) {
  std::vector<StrictTable> tables = root.Tables("effect");
  if (tables.empty()) return;
  if (tables.size() > static_cast<std::size_t>(kMaxEffects))
    throw root.Error("effect", "a model takes at most " + std::to_string(kMaxEffects) + " effects, there are " +
                                   std::to_string(tables.size()));
  std::vector<std::string> names;
  for (const EffectInfo* info : model.compiled->effects) names.emplace_back(info->name);
  settings->num_effects = 0;
  for (StrictTable& table : tables) {
    EffectSettings& effect = settings->effects[static_cast<std::size_t>(settings->num_effects++)];
    effect = MakeEffect(model, table.RequiredChoice("name", names));
    ReadEffect(table, model, &effect);
  }
}

}  // namespace armcmc::support
