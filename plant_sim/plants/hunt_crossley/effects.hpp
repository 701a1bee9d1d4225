#pragma once

#include <memory>
#include <vector>

#include "armcmc/plant_sim/effects/effect.hpp"
#include "armcmc/plant_sim/effects/gap_meter.hpp"
#include "armcmc/plant_sim/effects/model_form.hpp"

namespace armcmc::plant_sim {

/// Effects of the contact by kind of physics.
[[nodiscard]] std::vector<EffectSpec> ForceEffects();
[[nodiscard]] std::vector<EffectSpec> FrictionEffects();
[[nodiscard]] std::vector<EffectSpec> MaterialEffects();
[[nodiscard]] std::vector<EffectSpec> SensorEffects();

/// Least squares of K, B, p against the force.
[[nodiscard]] std::unique_ptr<GapMeter> MakeContactGapMeter(const Scenario& scenario);

/// A model file whose base is the contact.
[[nodiscard]] const ModelForm& ContactModelForm();

}  // namespace armcmc::plant_sim
