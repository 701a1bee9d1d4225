#pragma once

#include <memory>
#include <vector>

#include "armcmc/plant_sim/effects/hidden_effect.hpp"

namespace armcmc::plant_sim {

/// The effects of a run between its plant and its sensors, in the order of their stages.
class EffectChain {
 public:
  /// @param plant must outlive the chain: its law is evaluated with it.
  EffectChain(const std::vector<HiddenEffect>& effects, const EffectTiming& timing, const Plant* plant);

  /// What reaches the sensors at the next sample. @rt No heap, no lock, no throw.
  [[nodiscard]] const PlantSample& Apply(const PlantSample& truth) noexcept;

 private:
  struct Link {
    EffectStage stage;
    Gate gate;
    std::unique_ptr<Effect> effect;
  };
  void Differentiate(const PlantSample& truth) noexcept;

  std::vector<Link> links_;
  std::size_t law_at_ = 0;  ///< Links before this one feed the law.
  const Plant* plant_;
  double dt_;
  EffectSignal signal_;
  double last_[2] = {0.0, 0.0};  ///< Velocities one and two samples ago.
  int samples_ = 0;              ///< Counted up to 2.
};

}  // namespace armcmc::plant_sim
