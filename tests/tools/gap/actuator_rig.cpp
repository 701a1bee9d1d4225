#include "tools/gap/actuator_rig.hpp"

#include <stdexcept>

#include "armcmc/plant_sim/effects/hide.hpp"
#include "armcmc/plant_sim/simulation.hpp"
#include "builtin_scenario.hpp"

namespace armcmc::gap::test {

Recording RecordPlant(const std::string& name, const std::vector<HiddenInPlant>& hidden, unsigned long long seed,
                      double seconds, bool noisy) {
  plant_sim::Scenario scenario = plant_sim::BuiltinScenario(name);
  scenario.duration_s = seconds;
  std::vector<plant_sim::EffectRequest> requests;
  for (const HiddenInPlant& effect : hidden) {
    if (effect.values.empty()) {
      plant_sim::EffectRequest request;
      request.name = effect.name;
      request.gap_ratio = effect.gap_ratio;
      requests.push_back(request);
      continue;
    }
    for (const plant_sim::EffectSpec& spec : plant_sim::EffectRegistry(*scenario.family))
      if (spec.name == effect.name) scenario.hidden.push_back({&spec, effect.values, {}, 0.0});
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
  recording.names = {"t", "u_c", "u_d", "p", "pdot", "alpha"};
  recording.columns.assign(recording.names.size(), Vector(rows));
  for (Eigen::Index i = 0; i < rows; ++i) {
    if (!simulation.Next()) throw std::runtime_error(name + ": the plant leaves the finite range");
    const plant_sim::PlantSample& s = simulation.measured();
    recording.columns[0][i] = s.t_s;
    for (std::size_t c = 0; c < 4; ++c) recording.columns[c + 1][i] = s.inputs[c];
    recording.columns[5][i] = s.output;
  }
  recording.t = recording.columns[0];
  return recording;
}

}  // namespace armcmc::gap::test
