#include "armcmc/bench/workload.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <stdexcept>

#include "armcmc/adjust_result.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/models/registry.hpp"
#include "armcmc/replay/pack_source.hpp"
#include "armcmc/support/model_file.hpp"
#include "armcmc/support/plant_file.hpp"
#include "armcmc/support/plant_library.hpp"
#include "armcmc/support/recording.hpp"
#include "armcmc/support/subprocess.hpp"

namespace armcmc::bench {
namespace {

constexpr std::size_t kMostPacks = 64, kFewestPacks = 3;
constexpr double kSampleTime = 1e-3;  // s
const std::string kByTape = ":tape";

bool IsBuiltIn(const std::string& model) {
  const auto all = CompiledModels();
  return std::any_of(all.begin(), all.end(), [&](const ModelInfo* info) { return info->name == model; });
}

std::filesystem::path Simulated(const Plant& plant, const std::filesystem::path& folder) {
  const std::string base = plant.name.substr(0, plant.name.find(':'));
  std::filesystem::path csv = folder / (base + ".csv");
  if (std::filesystem::exists(csv)) return csv;
  std::vector<std::string> arguments = {"--seed", "1", "--csv", csv.string()};
  if (IsBuiltIn(base)) {
    arguments.insert(arguments.end(), {"--scenario", base + "_paper"});
  } else {
    arguments.insert(arguments.end(), {"--model", plant.model, "--duration", "20"});
  }
  const support::SubprocessEnd end = support::RunSubprocess(support::SiblingProgram("armcmc-plant"), arguments, folder);
  if (end.code != 0) throw std::runtime_error("armcmc-plant cannot simulate " + plant.model + ": " + end.errors);
  return csv;
}

std::unique_ptr<replay::PackSource> Open(const std::filesystem::path& csv, const EstimatorSettings& settings,
                                         const Estimator& estimator, const Plant& plant, int samples) {
  replay::SourceRequest request;
  request.plant = estimator.plant();
  request.num_inputs = estimator.num_inputs();
  request.period = samples * kSampleTime;
  request.described = settings.plant;
  request.data = csv;
  if (settings.plant != nullptr)
    request.recording = std::make_shared<support::Recording>(support::ReadRecordedCsv(csv, plant.model, false));
  for (int mode = 0; mode < estimator.num_modes(); ++mode) request.mode_names.emplace_back(estimator.mode_name(mode));
  return replay::OpenSource(request);
}

}  // namespace

EstimatorSettings SettingsOf(const Plant& plant) {
  if (auto described = support::DescribedPlant(plant.model)) return DescribedSettings(std::move(described));
  return support::ReadModel(plant.model);
}

std::vector<Plant> KnownPlants() {
  std::vector<Plant> plants;
  for (const ModelInfo* info : CompiledModels()) {
    const std::string name(info->name);
    plants.push_back({name, name});
    plants.push_back({name + kByTape, support::FindPlantFile(name).string()});
  }
  for (const std::string& name : support::PlantNames())
    if (!IsBuiltIn(name)) plants.push_back({name, name});
  return plants;
}

std::vector<DataPack> FullPacks(const Plant& plant, int samples, const std::filesystem::path& folder) {
  EstimatorSettings settings = SettingsOf(plant);
  settings.sampler.rule = DrawRule::kFixed;  // whether a mode is full does not depend on the draws
  settings.sampler.fixed_draws = SamplerSettings::kMinDraws;
  Estimator estimator(settings);
  const auto source = Open(Simulated(plant, folder), settings, estimator, plant, samples);
  const auto result = estimator.MakeResult();
  std::vector<DataPack> packs;
  replay::RecordedPack next;
  while (packs.size() < kMostPacks && source->Next(&next)) {
    (void)estimator.Adjust(next.pack, std::numeric_limits<Nanos>::max(), ClockRef(), result.get());
    const bool full = std::any_of(result->modes.begin(), result->modes.begin() + result->num_modes,
                                  [&](const ModeDraws& mode) { return mode.num_samples == next.pack.num_samples; });
    if (full) packs.push_back(next.pack);
  }
  if (packs.size() < kFewestPacks)
    throw std::runtime_error("the simulated data of " + plant.model + " have fewer than three full packs of " +
                             std::to_string(samples) + " samples");
  return packs;
}

}  // namespace armcmc::bench
