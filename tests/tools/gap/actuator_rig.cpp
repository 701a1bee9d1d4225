#include "tools/gap/actuator_rig.hpp"

#include <stdexcept>

#include "armcmc/plant_sim/effects/hide.hpp"
#include "armcmc/plant_sim/simulation.hpp"
#include "scenario_file.hpp"
#include "support/paths.hpp"

namespace armcmc::gap::test {

Recording RecordPlant(const std::string& name, const std::vector<HiddenInPlant>& hidden, unsigned long long seed,
                      double seconds, bool noisy, bool drawn, double law_error) {
  plant_sim::Scenario scenario = plant_sim::LoadScenario(
      armcmc::test::SourceDir() / "plant_sim" / "scenarios" / (name + ".toml"), {}, drawn ? seed : 1);
  scenario.duration_s = seconds;
  if (law_error > 0.0) scenario.options.Set("error", law_error);
  std::vector<plant_sim::EffectRequest> requests;
  for (const HiddenInPlant& effect : hidden) {
    if (effect.values.empty()) {
      plant_sim::EffectRequest request;
      request.name = effect.name;
      request.variant = effect.variant;
      request.gap_ratio = effect.gap_ratio;
      requests.push_back(request);
      continue;
    }
    for (const plant_sim::EffectSpec& spec : plant_sim::EffectRegistry(*scenario.family)) {
      if (spec.name != effect.name || (!effect.variant.empty() && spec.variant != effect.variant)) continue;
      scenario.hidden.push_back({&spec, effect.values, {}, 0.0});
      break;
    }
  }
  for (plant_sim::HiddenEffect& effect : plant_sim::DecideEffects(scenario, requests, seed))
    scenario.hidden.push_back(effect);
  if (!noisy)
    for (plant_sim::NoiseLaw& law : scenario.noise) law = {};
  plant_sim::Simulation simulation(scenario, seed);
  const auto rows = static_cast<Eigen::Index>(seconds / scenario.sample_interval_s);
  Recording recording;
  recording.source = name;
  recording.dt = scenario.sample_interval_s;
  const std::size_t inputs = scenario.family->inputs.size();
  recording.names = {"t"};
  for (const plant_sim::ChannelSpec& input : scenario.family->inputs) recording.names.push_back(input.name);
  recording.names.push_back(scenario.family->output.name);
  recording.columns.assign(recording.names.size(), Vector(rows));
  for (Eigen::Index i = 0; i < rows; ++i) {
    if (!simulation.Next()) throw std::runtime_error(name + ": the plant leaves the finite range");
    const plant_sim::PlantSample& s = simulation.measured();
    recording.columns[0][i] = s.t_s;
    for (std::size_t c = 0; c < inputs; ++c) recording.columns[c + 1][i] = s.inputs[c];
    recording.columns.back()[i] = s.output;
  }
  recording.t = recording.columns[0];
  return recording;
}

}  // namespace armcmc::gap::test
