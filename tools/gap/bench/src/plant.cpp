#include "armcmc/gap_bench/plant.hpp"

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "armcmc/gap/equation.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/subprocess.hpp"
#include "contents.hpp"

namespace armcmc::gap_bench {
namespace {

using Json = nlohmann::json;

/// Leaves the first columns, those that a robot would record: the ones after them are the plant's own truth.
void HideTruth(const std::filesystem::path& path, std::size_t columns) {
  std::istringstream lines(Contents(path));
  std::string kept;
  for (std::string line; std::getline(lines, line);) {
    std::size_t end = 0;
    for (std::size_t c = 0; c < columns && end != std::string::npos; ++c) end = line.find(',', end + (c > 0 ? 1 : 0));
    kept.append(line, 0, end);
    kept += '\n';
  }
  std::ofstream(path, std::ios::binary) << kept;
}

std::string Number(const Json& value) { return value.dump(); }

std::string NoiseTables(const Json& noise) {
  std::string text;
  for (const auto& [channel, law] : noise.items()) {
    if (law.at("kind") == "none") continue;
    text += "\n[noise." + channel + "]\nkind = " + law.at("kind").dump() + "\nstd = " + Number(law.at("std")) +
            "\ngrowth = " + Number(law.at("growth")) + "\n";
    if (law.at("kind") != "recorded") text += "correlation = " + Number(law.at("correlation")) + "\n";
    for (const char* key : {"dof", "outlier_weight", "outlier_scale", "recording"})
      if (law.contains(key)) text += std::string(key) + " = " + law.at(key).dump() + "\n";
  }
  return text;
}

/// A TOML float: JSON writes 3.0 as 3.0 and 1e-7 as 1e-07, which TOML reads, too.
std::string Toml(double value) { return Json(value).dump(); }

}  // namespace

PlantProcess::PlantProcess(const std::filesystem::path& program, const std::filesystem::path& folder)
    : program_(std::filesystem::absolute(program)), folder_(std::filesystem::absolute(folder)) {
  std::filesystem::create_directories(folder_);
}

std::vector<std::string> PlantProcess::Arguments(const Case& what) {
  std::vector<std::string> arguments = {"--scenario", what.scenario, "--seed", std::to_string(what.seed)};
  if (!what.effect.empty()) {
    arguments.insert(arguments.end(), {"--hide-effect", what.effect});
    if (what.effect != "none") arguments.insert(arguments.end(), {"--effect-strength", Json(what.strength).dump()});
    if (!what.gate.empty()) arguments.insert(arguments.end(), {"--effect-gate", what.gate});
  }
  arguments.insert(arguments.end(), {"--sealed", what.Name() + ".sealed.json", "--csv", what.Name() + ".csv"});
  return arguments;
}

std::filesystem::path PlantProcess::Recording(const Case& what) const { return folder_ / (what.Name() + ".csv"); }
std::filesystem::path PlantProcess::Sealed(const Case& what) const { return folder_ / (what.Name() + ".sealed.json"); }

void PlantProcess::Remove(const Case& what) const {
  std::filesystem::remove(Recording(what));
  std::filesystem::remove(Sealed(what));
}

bool PlantProcess::Make(const Case& what) const {
  const support::SubprocessEnd end = support::RunSubprocess(program_, Arguments(what), folder_);
  // Out of reach is the one bad input that a case may be.
  if (end.code == support::kExitBadInput && end.errors.find("gap ratio") != std::string::npos) return false;
  if (end.code != 0) throw std::runtime_error(program_.string() + " for " + what.Name() + ": " + end.errors);
  HideTruth(Recording(what), gap::ColumnsOf(what.model).size());
  return true;
}

gap::Recording PlantProcess::Rerun(const Case& what, const std::string& scenario_text) const {
  const std::string name = what.Name() + "_contribution";
  const std::filesystem::path scenario = folder_ / (name + ".toml"), csv = folder_ / (name + ".csv");
  std::ofstream(scenario, std::ios::binary) << scenario_text;
  const support::SubprocessEnd end = support::RunSubprocess(
      program_, {"--scenario", scenario.string(), "--seed", std::to_string(what.seed), "--csv", csv.string()}, folder_);
  if (end.code != 0) throw std::runtime_error(program_.string() + " for " + name + ": " + end.errors);
  gap::Recording recording = gap::ReadRecording(csv, gap::ColumnsOf(what.model), false);
  for (const std::filesystem::path& path : {scenario, csv}) std::filesystem::remove(path);
  return recording;
}

std::vector<std::vector<double>> PlantProcess::Outputs(const Case& what, const std::string& scenario_text) const {
  const gap::Recording recording = Rerun(what, scenario_text);
  std::vector<std::vector<double>> outputs;
  for (const std::string& output : OutputsOf(what.model)) {
    const gap::Vector& column = recording.Column(output);
    outputs.emplace_back(column.begin(), column.end());
  }
  return outputs;
}

std::vector<std::string> OutputsOf(const std::string& model) {
  std::vector<std::string> outputs;
  for (const auto& equation : gap::MakeEquations(model)) outputs.push_back(equation->columns().back());
  return outputs;
}

Truth ReadSealed(const std::filesystem::path& path, const std::string& model) {
  try {
    const Json sealed = Json::parse(Contents(path));
    Truth truth;
    for (const Json& effect : sealed.at("effects")) {
      TrueEffect one;
      one.name = effect.at("name");
      one.variant = effect.at("variant");
      one.kind = effect.at("formula_kind");
      one.gate = effect.at("gate");
      if (!effect.at("onset_s").is_null()) one.onset_s = effect.at("onset_s").get<double>();
      for (const auto& [name, parameter] : effect.at("parameters").items())
        one.parameters.emplace_back(name, parameter.at("value").get<double>());
      truth.effects.push_back(std::move(one));
    }
    for (const auto& [name, value] : sealed.at("base_parameters").items())
      truth.base_parameters.emplace_back(name, value.get<double>());
    truth.noise_tables = NoiseTables(sealed.at("noise"));
    for (const std::string& output : OutputsOf(model))
      truth.noise_sd.push_back(sealed.at("noise").at(output).at("sd").get<double>());
    return truth;
  } catch (const Json::exception& error) {
    throw std::runtime_error(path.string() + ": " + error.what());
  }
}

std::string EffectTables(const Truth& truth, bool gates) {
  std::string text;
  for (const TrueEffect& effect : truth.effects) {
    text += "\n[[hidden_effect]]\nname = \"" + effect.name + "\"\nvariant = \"" + effect.variant + "\"\ngate = \"" +
            (gates ? effect.gate : "always") + "\"\n[hidden_effect.parameters]\n";
    for (const auto& [name, value] : effect.parameters) text += name + " = " + Toml(value) + "\n";
  }
  return text;
}

}  // namespace armcmc::gap_bench
