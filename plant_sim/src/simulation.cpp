#include "armcmc/plant_sim/simulation.hpp"

#include <cmath>

namespace armcmc::plant_sim {

Simulation::Simulation(const Scenario& scenario, std::uint64_t seed)
    : plant_(scenario.MakePlant()), sensors_(scenario.noise, seed), num_inputs_(scenario.family->num_inputs()) {
  if (scenario.hidden.empty()) return;
  const EffectTiming timing{scenario.sample_interval_s, scenario.duration_s};
  plant_->Hide(scenario.hidden, timing);
  effects_.emplace(scenario.hidden, timing, plant_.get());
}

bool Simulation::Next() noexcept {
  plant_->Advance(&truth_);
  sensors_.Measure(effects_ ? effects_->Apply(truth_) : truth_, &measured_);
  ++index_;
  bool finite = std::isfinite(measured_.output);
  for (int i = 0; i < num_inputs_; ++i) finite = finite && std::isfinite(measured_.inputs[static_cast<std::size_t>(i)]);
  return finite;
}

}  // namespace armcmc::plant_sim
