#pragma once

#include <memory>
#include <vector>

#include "armcmc/plant_sim/effects/effect.hpp"
#include "armcmc/plant_sim/effects/gap_meter.hpp"
#include "armcmc/plant_sim/effects/model_form.hpp"

namespace armcmc::plant_sim {

[[nodiscard]] std::vector<EffectSpec> ActuatorEffects();

/// R of the flow equation or of the bend equation, whichever is larger.
[[nodiscard]] std::unique_ptr<GapMeter> MakeActuatorGapMeter(const Scenario& scenario);

/// A model file whose base is the actuator.
[[nodiscard]] const ModelForm& ActuatorModelForm();

}  // namespace armcmc::plant_sim
