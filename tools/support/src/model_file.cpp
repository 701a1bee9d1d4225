#include "armcmc/support/model_file.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "armcmc/models/registry.hpp"
#include "armcmc/support/plant_file.hpp"
#include "armcmc/support/plant_library.hpp"
#include "model_tables.hpp"
#include "nearest.hpp"

namespace armcmc::support {
namespace {

/// Shortest of the forms that reads back to the same bits, always a TOML float.
std::string Text(double value) {
  char buffer[40];
  for (int digits = 15; digits <= 17; ++digits) {
    std::snprintf(buffer, sizeof buffer, "%.*g", digits, value);
    if (std::stod(buffer) == value) break;
  }
  std::string text = buffer;
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

void WritePrior(const ParameterSettings& p, const char* between, std::ostream& out) {
  if (p.prior == PriorKind::kUniform) {
    out << "prior = \"uniform\"" << between;
  } else {
    out << "prior = \"normal\"" << between << "mean = " << Text(p.mean) << between << "sd = " << Text(p.sd) << between;
  }
  out << "lower = " << Text(p.lower) << between << "upper = " << Text(p.upper);
}

void WriteNoise(const std::string& mode, const NoiseSettings& noise, std::ostream& out) {
  static constexpr const char* kKinds[] = {"gaussian", "student_t", "laplace", "mixture"};
  out << "\n[noise." << mode << "]\nkind = \"" << kKinds[static_cast<std::size_t>(noise.kind)]
      << "\"\nstd = " << Text(noise.std) << "\nmean = " << Text(noise.mean)
      << "\nestimate_std = " << (noise.estimate_std ? "true" : "false") << "\nstd_log_sd = " << Text(noise.std_log_sd)
      << "\ndof = " << Text(noise.dof) << "\noutlier_weight = " << Text(noise.outlier_weight)
      << "\noutlier_scale = " << Text(noise.outlier_scale) << '\n';
}

void WriteEffect(const EffectSettings& effect, const ModelInfo& model, std::ostream& out) {
  const EffectInfo& info = *FindEffect(model, effect.name);
  out << "\n[[effect]]\nname = \"" << effect.name << "\"\n";
  switch (effect.gate) {
    case EffectGate::kAlways: out << "when = \"always\"\n"; break;
    case EffectGate::kContact: out << "when = \"contact\"\n"; break;
    case EffectGate::kFree: out << "when = \"free\"\n"; break;
    case EffectGate::kFrom: out << "from_s = " << Text(effect.from_s) << '\n'; break;
    case EffectGate::kUntil: out << "until_s = " << Text(effect.until_s) << '\n'; break;
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(info.num_shapes); ++i)
    out << info.shapes[i].name << " = " << Text(effect.shapes[i]) << "  # " << info.shapes[i].unit << '\n';
  for (std::size_t i = 0; i < static_cast<std::size_t>(info.num_amplitudes); ++i) {
    out << info.amplitudes[i].name << " = { ";
    WritePrior(effect.amplitudes[i], ", ", out);
    out << " }  # " << info.amplitudes[i].unit << '\n';
  }
}

EstimatorSettings Builtin(const std::string& name, const std::string& place) {
  try {
    return BuiltinSettings(name);
  } catch (const std::invalid_argument& error) {
    const std::vector<std::string> plants = PlantNames();
    std::string there;
    for (const std::string& plant : plants) there += (there.empty() ? "; plants are " : ", ") + plant;
    throw ConfigError(place + ": " + error.what() + there + DidYouMean(name, plants));
  }
}

}  // namespace

bool IsModelFile(const std::string& model) {
  std::error_code ignored;
  return model.ends_with(".toml") || std::filesystem::is_regular_file(model, ignored);
}

std::shared_ptr<const PlantProgram> DescribedPlant(const std::string& model) {
  if (!IsModelFile(model)) {
    try {
      (void)BuiltinSettings(model);
      return nullptr;
    } catch (const std::invalid_argument&) {
      const std::vector<std::string> names = PlantNames();
      if (std::find(names.begin(), names.end(), model) == names.end()) return nullptr;
      return ReadPlantProgram(FindPlantFile(model));
    }
  }
  const StrictTable root = StrictTable::FromFile(model);
  return root.Has("signals") || root.Has("law") || root.Has("mode") ? ReadPlantProgram(model) : nullptr;
}

std::string BaseModel(const std::string& model) {
  if (DescribedPlant(model) != nullptr)
    throw ConfigError("--model " + model +
                      ": is a plant file, which armcmc-replay runs; expected a built-in model or a " +
                      "model file (base = \"" + DefaultModel() + "\")");
  if (!IsModelFile(model)) {
    (void)Builtin(model, "--model " + model);
    return model;
  }
  StrictTable root = StrictTable::FromFile(model);
  root.RequireSchema();
  std::string base = root.RequiredText("base");
  try {
    (void)BuiltinSettings(base);
  } catch (const std::invalid_argument& error) {
    throw root.Error("base", error.what());
  }
  return base;
}

void ApplyModelFile(const std::string& path, EstimatorSettings* settings) {
  StrictTable root = StrictTable::FromFile(path);
  root.RequireSchema();
  (void)root.RequiredText("base");
  const ModelFacts facts = FactsOf(*settings);
  ReadParameters(root.Table("parameters"), settings);
  ReadConstants(root, *facts.model, settings);
  ReadRegressRate(root, *facts.model, settings);
  ReadNoise(root.Table("noise"), facts.modes, settings);
  ReadEffects(root, *facts.model, settings);
  root.Finish();
}

EstimatorSettings ReadModel(const std::string& model) {
  EstimatorSettings settings = BuiltinSettings(BaseModel(model));
  if (!IsModelFile(model)) return settings;
  ApplyModelFile(model, &settings);
  try {
    settings.Validate();
  } catch (const std::invalid_argument& error) {
    throw ConfigError(model + ": " + error.what());
  }
  return settings;
}

std::string ModelFileText(const EstimatorSettings& settings, const std::string& base) {
  const ModelFacts facts = FactsOf(settings);
  std::ostringstream out;
  out << "schema = 1\nbase = \"" << (base.empty() ? settings.model : base) << "\"\n";
  if (facts.model->compiled != nullptr && !facts.model->compiled->rate_unit.empty())
    out << "regress_rate = " << (settings.regress_rate ? "true" : "false") << '\n';
  for (int d = 0; d < settings.num_parameters; ++d) {
    const ParameterSettings& p = settings.parameters[static_cast<std::size_t>(d)];
    out << "\n[parameters." << p.name << "]\n";
    WritePrior(p, "\n", out);
    out << '\n';
  }
  const std::span<const ConstantInfo> constants = ConstantsOf(*facts.model);
  if (!constants.empty()) out << "\n[constants]\n";
  for (std::size_t i = 0; i < constants.size(); ++i)
    out << constants[i].name << " = " << Text(settings.constants[i]) << '\n';
  for (std::size_t m = 0; m < facts.modes.size(); ++m) WriteNoise(facts.modes[m], settings.noise[m], out);
  for (int e = 0; e < settings.num_effects; ++e)
    WriteEffect(settings.effects[static_cast<std::size_t>(e)], *facts.model, out);
  return out.str();
}

}  // namespace armcmc::support
