#include "scenario_file.hpp"

#include <algorithm>
#include <armcmc/support/strict_toml.hpp>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "armcmc/data_pack_t.hpp"
#include "armcmc/plant_sim/effects/hide.hpp"
#include "drawn_parameters.hpp"
#include "noise_table.hpp"
#include "series_file.hpp"

namespace armcmc::plant_sim {
namespace {

using support::ConfigError;
using support::StrictTable;

constexpr int kMaxSamples = data_pack_t::MAX_SAMPLES;
constexpr double kMaxDuration = 1e6;  // s, eleven days

std::vector<std::string> FamilyNames() {
  std::vector<std::string> names;
  for (const PlantFamily* family : PlantRegistry()) names.push_back(family->name);
  return names;
}

int ReadPackSamples(StrictTable* root, double interval) {
  const double period = root->Number("pack_period_s", 0.1, 1e-3, 10.0);
  const double samples = period / interval;
  const double whole = std::round(samples);
  if (whole < 1.0 || whole > kMaxSamples || std::abs(samples - whole) > 1e-6)
    throw root->Error("pack_period_s", "must hold a whole number of sample intervals, 1 to " +
                                           std::to_string(kMaxSamples) + "; it holds " + std::to_string(samples));
  return static_cast<int>(whole);
}

int ReadPackStride(StrictTable* root, int pack_samples) {
  if (!root->Has("pack_stride")) return 0;
  const auto stride = static_cast<int>(root->Integer("pack_stride", pack_samples, 1, pack_samples));
  if (pack_samples % stride != 0)
    throw root->Error("pack_stride", "must divide the " + std::to_string(pack_samples) + " samples of a pack");
  return stride;
}

int ParameterIndex(const PlantFamily& family, const std::string& name) {
  const auto it = std::find_if(family.parameters.begin(), family.parameters.end(),
                               [&name](const ParameterSpec& spec) { return spec.name == name; });
  return static_cast<int>(it - family.parameters.begin());
}

Schedule ReadSchedule(StrictTable* root, const PlantFamily& family, std::uint64_t seed) {
  std::vector<double> initial = ReadParameters(root->Table("parameters"), family, seed);
  std::vector<std::string> names;
  for (const ParameterSpec& spec : family.parameters) names.push_back(spec.name);
  std::vector<Change> changes;
  for (StrictTable& entry : root->Tables("change")) {
    Change change;
    change.parameter = ParameterIndex(family, entry.RequiredChoice("parameter", names));
    const ParameterSpec& spec = family.parameters[static_cast<std::size_t>(change.parameter)];
    change.from_s = entry.RequiredNumber("from_s", 0.0, kMaxDuration);
    change.to_s = entry.Number("to_s", change.from_s, change.from_s, kMaxDuration);
    change.to_value = entry.RequiredNumber("to_value", spec.lo, spec.hi);
    changes.push_back(change);
  }
  try {
    return {std::move(initial), std::move(changes)};
  } catch (const std::invalid_argument& error) {
    throw root->Error("change", error.what());
  }
}

Options ReadOptions(StrictTable* root, const PlantFamily& family, const std::filesystem::path& file) {
  Options options(family.options);
  for (const OptionSpec& spec : family.options) {
    StrictTable table = root->Table(spec.table);
    switch (spec.kind) {
      case OptionSpec::Kind::kNumber:
        options.Set(spec.key, table.Number(spec.key, spec.number, spec.lo, spec.hi));
        break;
      case OptionSpec::Kind::kList:
        options.Set(spec.key, table.Numbers(spec.key, spec.list, 0, kMaxOptionList, spec.lo, spec.hi));
        break;
      case OptionSpec::Kind::kChoice:
        options.Set(spec.key, table.Choice(spec.key, spec.choices.front(), spec.choices));
        break;
      case OptionSpec::Kind::kSeries:
        if (table.Has(spec.key)) options.Set(spec.key, ReadSeries(table.RequiredText(spec.key), file, spec.column));
        break;
    }
  }
  return options;
}

/// Keys of [hidden_effect.parameters], which only a chosen formula gives a meaning.
void ReadEffectValues(StrictTable table, const EffectSpec* spec, EffectRequest* request) {
  if (table.Keys().empty()) return;
  if (spec == nullptr) throw table.Error(table.Keys().front(), "needs the effect's variant");
  for (const EffectParameter& parameter : spec->parameters)
    if (table.Has(parameter.name))
      request->values.emplace_back(parameter.name, table.RequiredNumber(parameter.name, -1e9, 1e9));
}

struct HiddenEffects {
  std::vector<EffectRequest> requests;
  std::uint64_t seed = 1;
};

HiddenEffects ReadHiddenEffects(StrictTable* root, const PlantFamily& family) {
  HiddenEffects hidden;
  for (StrictTable& entry : root->Tables("hidden_effect")) {
    EffectRequest request;
    request.name = entry.RequiredChoice("name", EffectNames(family));
    std::vector<std::string> variants;
    for (const EffectSpec& spec : EffectRegistry(family))
      if (spec.name == request.name) variants.push_back(spec.variant);
    if (entry.Has("variant")) request.variant = entry.RequiredChoice("variant", variants);
    try {
      request.gate = Gate::Parse(entry.Text("gate", "always"));
    } catch (const std::invalid_argument& error) {
      throw entry.Error("gate", error.what());
    }
    request.gap_ratio = entry.Number("strength", 1.0, 1e-3, 1e3);
    if (hidden.requests.empty()) {
      constexpr std::int64_t kMaxSeed = 1'000'000'000;
      hidden.seed = static_cast<std::uint64_t>(entry.Integer("seed", 1, 0, kMaxSeed));
    }
    const std::string variant = variants.size() == 1 ? variants.front() : request.variant;
    const EffectSpec* spec = FindEffectSpec(family, request.name, variant);
    ReadEffectValues(entry.Table("parameters"), spec, &request);
    if (entry.Has("strength"))
      for (const auto& value : request.values)
        if (value.first == spec->parameters.front().name)
          throw entry.Error("strength", "contradicts parameters." + value.first + ", which it would find");
    hidden.requests.push_back(std::move(request));
  }
  return hidden;
}

}  // namespace

Scenario LoadScenario(const std::filesystem::path& path, std::optional<double> duration_s, std::uint64_t seed) {
  StrictTable root = StrictTable::FromFile(path);
  root.RequireSchema();
  Scenario scenario;
  scenario.name = path.stem().string();
  scenario.seed = seed;
  scenario.family = FindPlantFamily(root.RequiredChoice("plant", FamilyNames()));
  scenario.duration_s = root.Number("duration_s", scenario.duration_s, 1e-3, kMaxDuration);
  scenario.sample_interval_s = root.Number("sample_interval_s", scenario.sample_interval_s, 1e-5, 1.0);
  scenario.pack_samples = ReadPackSamples(&root, scenario.sample_interval_s);
  scenario.pack_stride = ReadPackStride(&root, scenario.pack_samples);
  scenario.schedule = ReadSchedule(&root, *scenario.family, seed);
  scenario.options = ReadOptions(&root, *scenario.family, path);
  scenario.noise = ReadNoise(root.Table("noise"), *scenario.family, seed, path);
  const HiddenEffects hidden = ReadHiddenEffects(&root, *scenario.family);
  root.Finish();
  if (duration_s) scenario.duration_s = *duration_s;
  try {
    static_cast<void>(scenario.MakePlant());
    ResolveNoise(&scenario);
    scenario.hidden = DecideEffects(scenario, hidden.requests, hidden.seed);
  } catch (const std::invalid_argument& error) {
    throw ConfigError(path.string() + ": " + error.what());
  }
  return scenario;
}

}  // namespace armcmc::plant_sim
