#include "options.hpp"

#include <algorithm>
#include <filesystem>

#include "armcmc/models/registry.hpp"
#include "armcmc/rt/pipeline.hpp"
#include "armcmc/support/estimator_config.hpp"
#include "armcmc/support/model_file.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/shared_files.hpp"
#include "armcmc/support/strict_toml.hpp"
#include "rt_config.hpp"

namespace armcmc::app {
namespace {

/// Without --config a built-in model has a file of its own, a plant that a file describes the defaults; with --config,
/// --model replaces the model of the file.
support::StrictTable OpenConfiguration(const std::string& config, const std::string& model, bool described) {
  // A wrong name or model file is reported first: the error is in the model, not in the configuration.
  const std::string base = model.empty() || described ? DefaultModel() : support::BaseModel(model);
  if (described && config.empty()) return support::StrictTable::FromText("schema = 1\n", "the default configuration");
  return support::StrictTable::FromFile(support::FindSharedFile("config", config.empty() ? base : config));
}

/// A file that cannot be written is found out before the run, not after it.
void CheckPath(const std::string& option, const std::string& path) {
  if (path.empty()) return;
  const auto folder = std::filesystem::absolute(path).parent_path();
  if (!std::filesystem::is_directory(folder) || std::filesystem::is_directory(path))
    throw support::InputError(option + " " + path + ": expected a file in a folder that exists");
}

/// Entry i of an option that is given once for all plants, for each of them, or not at all.
std::string Of(const std::vector<std::string>& values, std::size_t i) {
  return values.empty() ? "" : values[values.size() == 1 ? 0 : i];
}

void CheckCount(const std::string& option, std::size_t given, std::size_t plants, bool may_be_shared) {
  if (given == 0 || given == plants || (may_be_shared && given == 1)) return;
  throw support::InputError(option + " is given " + std::to_string(given) + " times for " + std::to_string(plants) +
                            " plants: give it once for each, in their order" +
                            (may_be_shared ? ", or once for all" : ""));
}

}  // namespace

Configuration Load(const Options& options) {
  const std::size_t plants = std::max({options.config.size(), options.model.size(), std::size_t{1}});
  if (plants > rt::Pipeline::kMaxLanes)
    throw support::InputError("a process takes " + std::to_string(rt::Pipeline::kMaxLanes) + " plants at most, not " +
                              std::to_string(plants));
  CheckCount("--config", options.config.size(), plants, true);
  CheckCount("--model", options.model.size(), plants, true);
  CheckCount("--prefix", options.prefix.size(), plants, false);
  CheckCount("--report", options.report.size(), plants, false);
  CheckCount("--resume", options.resume.size(), plants, false);

  Configuration all;
  for (std::size_t i = 0; i < plants; ++i) {
    const std::string config = Of(options.config, i);
    const std::string model = Of(options.model, i);
    const bool described = support::DescribedPlant(model) != nullptr;
    support::StrictTable root = OpenConfiguration(config, model, described);
    const bool decides = described || !config.empty() || support::IsModelFile(model);
    PlantConfiguration plant;
    plant.estimator = support::ReadEstimatorSettings(root, decides ? model : "");
    rt::RtSettings rt = ReadRtSettings(root);
    plant.gap_log = ReadGapLogSettings(root);
    plant.gap_log.overlap = plant.estimator.overlap;
    const std::vector<rt::InjectionItem> inject = ReadInjections(root);
    root.Finish();
    all.inject.insert(all.inject.end(), inject.begin(), inject.end());
    if (!options.lcm_url.empty()) rt.lcm_url = options.lcm_url;
    plant.prefix = options.prefix.empty() ? rt.prefix : options.prefix[i];
    plant.report = Of(options.report, i);
    plant.resume = Of(options.resume, i);
    CheckPath("--report", plant.report);
    CheckPath("--resume", plant.resume);
    if (!plant.resume.empty() && plant.estimator.method != Method::kArmcmc)
      throw support::InputError("--resume: only method = \"armcmc\" saves its state; omit --resume");
    if (!options.gap_log.empty()) plant.gap_log.directory = options.gap_log;
    // Files of several plants have a folder each.
    if (plants > 1 && !plant.gap_log.directory.empty())
      plant.gap_log.directory = (std::filesystem::path(plant.gap_log.directory) / plant.prefix).string();
    for (const PlantConfiguration& other : all.plants)
      if (other.prefix == plant.prefix)
        throw support::InputError("two plants have the prefix \"" + plant.prefix +
                                  "\": give each one of its own, with --prefix or in [lcm] of its configuration");
    rt.prefix = plant.prefix;
    rt.Validate();
    rt.prefix.clear();
    if (i > 0 && rt != all.rt)
      throw support::InputError(config +
                                ": [timing], [rt] and the bus are those of all plants of a process, and differ "
                                "from those of " +
                                (Of(options.config, 0).empty() ? "the first plant" : Of(options.config, 0)));
    all.rt = rt;
    all.plants.push_back(std::move(plant));
  }
  if (plants > 1 && !all.inject.empty())
    throw support::InputError("[inject] makes faults in a process of one plant, not of " + std::to_string(plants));
  return all;
}

}  // namespace armcmc::app
