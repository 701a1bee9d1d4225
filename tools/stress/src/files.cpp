#include "armcmc/stress/files.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "armcmc/stress/stressed_plant.hpp"

namespace armcmc::stress {

std::string ScenarioText(const StressOptions& options) {
  std::ostringstream text;
  text.precision(12);
  const StressedPlant& plant = PlantUnderStress();
  text << std::showpoint << "schema = 1\nplant = \"" << plant.name
       << "\"\nduration_s = 3600.0\nsample_interval_s = " << options.period_ms * 1e-3 / options.samples
       << "\npack_period_s = " << options.period_ms * 1e-3 << '\n'
       << plant.scenario << "kind = \"gaussian\"\nstd = " << plant.noise_std << '\n';
  return text.str();
}

std::string EstimatorConfigText(const StressOptions& options, const std::string& plan) {
  const double most = std::min(options.period_ms, options.DeadlineMs());
  const bool is_word = options.draws == "chernoff" || options.draws == "k_min";
  const std::string draws = is_word ? "\"" + options.draws + "\"" : options.draws;
  std::ostringstream text;
  text.precision(12);
  text << std::showpoint << "schema = 1\n[model]\nname = \"" << PlantUnderStress().name
       << "\"\n[noise]\nkind = \"gaussian\"\nstd = " << PlantUnderStress().noise_std << "\n[sampler]\ndraws = " << draws
       << "\n[timing]\nperiod_ms = " << options.period_ms << "\ndeadline_ms = " << options.DeadlineMs()
       << "\nadjust_budget_ms = " << 0.8 * most << "\n[gap_log]\ndirectory = \"\"\n";
  if (!plan.empty()) text << "[inject]\nplan = \"" << plan << "\"\n";
  return text.str();
}

void WriteText(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file << text << std::flush;
  if (!file) throw std::runtime_error("cannot write " + path.string());
}

}  // namespace armcmc::stress
