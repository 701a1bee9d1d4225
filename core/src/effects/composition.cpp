#include "armcmc/effects/composition.hpp"

#include <cmath>

#include "armcmc/models/registry.hpp"

namespace armcmc {

Composition::Composition(const EstimatorSettings& settings)
    : info_(settings.plant != nullptr ? settings.plant->info()
                                      : *CompiledModels()[static_cast<std::size_t>(FindModel(settings.model))]),
      sampled_(settings),
      plant_(settings.plant),
      rows_(plant_ == nullptr ? info_.compiled->make_rows(settings) : nullptr) {
  if (rows_ == nullptr) return;
  for (int e = 0; e < settings.num_effects; ++e) {
    const EffectSettings& effect = settings.effects[static_cast<std::size_t>(e)];
    const EffectInfo& effect_info = *FindEffect(info_, effect.name);
    for (int a = 0; a < effect_info.num_amplitudes; ++a) {
      const EffectAmplitude& amplitude = effect_info.amplitudes[static_cast<std::size_t>(a)];
      const ParameterSettings& prior = effect.amplitudes[static_cast<std::size_t>(a)];
      const auto d = static_cast<std::size_t>(info_.num_parameters++);
      names_[d] = std::string(effect_info.name) + "_" + std::string(amplitude.name);
      info_.parameters[d] = {names_[d], amplitude.unit, prior.mean, prior.sd, prior.lower, prior.upper};
      info_.reported[static_cast<std::size_t>(info_.num_reported++)] = {names_[d], amplitude.unit};
      info_.num_added += 1;
      sampled_.parameters[d] = prior;
      sampled_.parameters[d].name = names_[d];
    }
  }
  for (LinearPart& part : info_.linear) {
    if (!rows_->additive_only()) part = {};
    if (part.num_linear == 0) continue;
    for (int d = info_.num_parameters - info_.num_added; d < info_.num_parameters; ++d)
      part.linear[static_cast<std::size_t>(part.num_linear++)] = d;
  }
  sampled_.num_parameters = info_.num_parameters;
  if (!rows_->target_unit().empty()) info_.target_unit = rows_->target_unit();
}

EffectPack Composition::MakePack() const {
  EffectPack pack;
  if (rows_ != nullptr) pack.compiled = rows_->MakePack();
  return pack;
}

bool Composition::effects_on_output() const noexcept { return rows_ != nullptr && info_.compiled->law_is_output; }

bool Composition::PrepareDescribed(const DataPack& pack, PlantPack* out) noexcept {
  const DescribedMemory& before = described_[static_cast<std::size_t>(current_)];
  DescribedMemory& after = described_[static_cast<std::size_t>(1 - current_)];
  const bool continues = before.last.ContinuesWith(pack);
  after.last = LastPack::Of(pack);
  if (plant_->has_memory()) after.features = before.features;
  if (!continues) after.features.Clear();
  if (!plant_->Prepare(pack, &after.features, continues ? &before.states : nullptr, out)) return false;
  after.states.known = false;
  plant_->Leave(*out, pack.num_samples, &after.states);
  current_ = 1 - current_;
  return true;
}

void Composition::CarryStates(const std::array<double, kMaxStates>& end) noexcept {
  StateMemory& memory = described_[static_cast<std::size_t>(current_)].states;
  memory.known = true;
  for (std::size_t s = 0; s < static_cast<std::size_t>(plant_->states().size()); ++s) {
    memory.state[s] = end[s];
    memory.known = memory.known && std::isfinite(memory.state[s]);
  }
}

bool Composition::Prepare(const DataPack& pack, EffectPack* out) noexcept {
  return plant_ != nullptr ? PrepareDescribed(pack, &out->described) : rows_->Prepare(pack, out->compiled.get());
}

void Composition::Fill(const DataPack& pack, const EffectPack& effects, int mode, ModeData* data) const noexcept {
  if (plant_ != nullptr) {
    plant_->Fill(effects.described, pack.num_samples, mode, data);
  } else {
    rows_->Fill(pack, *effects.compiled, mode, data);
  }
}

}  // namespace armcmc
