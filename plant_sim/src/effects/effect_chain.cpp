#include "armcmc/plant_sim/effects/effect_chain.hpp"

#include <algorithm>

namespace armcmc::plant_sim {

EffectChain::EffectChain(const std::vector<HiddenEffect>& effects, const EffectTiming& timing, const Plant* plant)
    : plant_(plant), dt_(timing.dt_s) {
  for (const HiddenEffect& effect : effects)
    if (effect.spec->make != nullptr)
      links_.push_back({effect.spec->stage, effect.gate, effect.spec->make(effect.values, timing)});
  std::stable_sort(links_.begin(), links_.end(), [](const Link& a, const Link& b) { return a.stage < b.stage; });
  while (law_at_ < links_.size() && links_[law_at_].stage <= EffectStage::kParameters) ++law_at_;
}

void EffectChain::Differentiate(const PlantSample& truth) noexcept {
  const double now = truth.inputs[1];
  if (samples_ >= 2) signal_.acceleration = (3.0 * now - 4.0 * last_[0] + last_[1]) / (2.0 * dt_);
  if (samples_ == 1) signal_.acceleration = (now - last_[0]) / dt_;
  if (samples_ < 2) ++samples_;
  last_[1] = last_[0];
  last_[0] = now;
}

const PlantSample& EffectChain::Apply(const PlantSample& truth) noexcept {
  signal_.truth = signal_.law = signal_.seen = truth;
  signal_.theta = plant_->Truth(0, truth.t_s);
  Differentiate(truth);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const EffectSignal before = signal_;
    links_[i].effect->Apply(&signal_);
    if (!links_[i].gate.Open(truth)) signal_ = before;
    if (i + 1 == law_at_) signal_.seen.output = plant_->Respond(signal_.theta, signal_.law);
  }
  return signal_.seen;
}

}  // namespace armcmc::plant_sim
