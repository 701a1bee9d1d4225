#pragma once

#include <cstddef>

#include "armcmc/effects/effect_list.hpp"
#include "plants/soft_actuator/effects/angle_bias.hpp"
#include "plants/soft_actuator/effects/angle_delay.hpp"
#include "plants/soft_actuator/effects/angle_disturbance.hpp"
#include "plants/soft_actuator/effects/cubic_stiffness.hpp"
#include "plants/soft_actuator/effects/gravity_load.hpp"
#include "plants/soft_actuator/effects/hysteresis.hpp"
#include "plants/soft_actuator/effects/joint_friction.hpp"
#include "plants/soft_actuator/effects/leak.hpp"
#include "plants/soft_actuator/effects/payload_step.hpp"
#include "plants/soft_actuator/effects/pressure_bias.hpp"
#include "plants/soft_actuator/effects/supply_droop.hpp"
#include "plants/soft_actuator/effects/valve_dead_band.hpp"
#include "plants/soft_actuator/effects/valve_lag.hpp"

namespace armcmc {

/// The effects of the valve flow, in the order in which they act. Besides `static constexpr EffectInfo kInfo` each has,
/// whatever its slot, per candidate and sample:
///   template <class S> static void Apply(typename S::V amplitude, FlowPoint<S>* point)
/// which changes nothing for an amplitude of zero.
using FlowEffects = EffectList<PressureBias, ValveLag, ValveDeadBand, SupplyDroop, Leak>;

/// Every effect: those of the flow first, then those of the bending angle, for offline fits only.
using ActuatorEffects = EffectList<PressureBias, ValveLag, ValveDeadBand, SupplyDroop, Leak, AngleBias, JointFriction,
                                   CubicStiffness, Hysteresis, GravityLoad, PayloadStep, AngleDelay, AngleDisturbance>;

namespace effect_detail {
/// The fixed order: inputs first, then the law, then what is added to it.
constexpr bool ActInOrder() noexcept {
  for (std::size_t i = 0; i + 1 < FlowEffects::kInfos.size(); ++i)
    if (FlowEffects::kInfos[i]->slot > FlowEffects::kInfos[i + 1]->slot) return false;
  return true;
}
static_assert(ActInOrder());
}  // namespace effect_detail

}  // namespace armcmc
