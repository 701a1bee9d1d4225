#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

#include "armcmc/data_pack.hpp"
#include "armcmc/effects/adhesion.hpp"
#include "armcmc/effects/angle_bias.hpp"
#include "armcmc/effects/angle_delay.hpp"
#include "armcmc/effects/angle_disturbance.hpp"
#include "armcmc/effects/contact_offset.hpp"
#include "armcmc/effects/coulomb_friction.hpp"
#include "armcmc/effects/cubic_stiffness.hpp"
#include "armcmc/effects/force_bias.hpp"
#include "armcmc/effects/force_drift.hpp"
#include "armcmc/effects/gravity_load.hpp"
#include "armcmc/effects/hysteresis.hpp"
#include "armcmc/effects/inertia.hpp"
#include "armcmc/effects/joint_friction.hpp"
#include "armcmc/effects/leak.hpp"
#include "armcmc/effects/payload_step.hpp"
#include "armcmc/effects/periodic_disturbance.hpp"
#include "armcmc/effects/presliding_friction.hpp"
#include "armcmc/effects/pressure_bias.hpp"
#include "armcmc/effects/sensor_delay.hpp"
#include "armcmc/effects/sensor_lag.hpp"
#include "armcmc/effects/sensor_saturation.hpp"
#include "armcmc/effects/stiffness_drift.hpp"
#include "armcmc/effects/stress_relaxation.hpp"
#include "armcmc/effects/supply_droop.hpp"
#include "armcmc/effects/valve_dead_band.hpp"
#include "armcmc/effects/valve_lag.hpp"
#include "armcmc/effects/viscous_friction.hpp"
#include "armcmc/nonblocking.hpp"

namespace armcmc {

/// How the samples of an effect become numbers that do not depend on the candidate; null where there are none.
using EffectFeatureFn = void (*)(const EffectInput&, const double* shape, double* memory,
                                 double* feature) noexcept ARMCMC_NONBLOCKING;

namespace effect_detail {

template <class E>
void Elapsed(const EffectInput& in, const double* shape, double*, double* feature) noexcept ARMCMC_NONBLOCKING {
  feature[0] = E::Elapsed(in, shape);
}

template <class E>
constexpr EffectFeatureFn FeatureOf() noexcept {
  if constexpr (E::kInfo.slot == EffectSlot::kAdditive) {
    return &E::Feature;
  } else if constexpr (E::kInfo.slot == EffectSlot::kConstitutiveLaw) {
    return &Elapsed<E>;
  } else {
    return nullptr;
  }
}

}  // namespace effect_detail

template <class... Effects>
struct EffectList {
  static constexpr int kSize = sizeof...(Effects);
  static constexpr std::array<const EffectInfo*, sizeof...(Effects)> kInfos{&Effects::kInfo...};

  /// Index of the effect with that name, -1 if there is none.
  [[nodiscard]] static constexpr int Find(std::string_view name) noexcept {
    for (int i = 0; i < kSize; ++i)
      if (kInfos[static_cast<std::size_t>(i)]->name == name) return i;
    return -1;
  }
  /// Index of an effect; it must be in the list.
  template <class E>
  static constexpr std::size_t kIndexOf = static_cast<std::size_t>(Find(E::kInfo.name));

  /// Calls each(std::type_identity<E>, index) for every effect, in order.
  template <class Function>
  static constexpr void ForEach(Function&& each) {
    [&]<std::size_t... I>(std::index_sequence<I...>) { (each(std::type_identity<Effects>(), I), ...); }
    (std::make_index_sequence<sizeof...(Effects)>());
  }
};

/// Every effect of the contact plant. The index into this list identifies an effect.
using ContactEffects = EffectList<ForceBias, ForceDrift, CoulombFriction, PreslidingFriction, ViscousFriction, Inertia,
                                  SensorDelay, SensorLag, StressRelaxation, Adhesion, ContactOffset, SensorSaturation,
                                  PeriodicDisturbance, StiffnessDrift>;

/// Those of the soft actuator's valve flow, in the order in which they act.
using FlowEffects = EffectList<PressureBias, ValveLag, ValveDeadBand, SupplyDroop, Leak>;

/// Every effect of the soft actuator: those of the flow first, then those of the bending angle, for offline fits only.
using ActuatorEffects = EffectList<PressureBias, ValveLag, ValveDeadBand, SupplyDroop, Leak, AngleBias, JointFriction,
                                   CubicStiffness, Hysteresis, GravityLoad, PayloadStep, AngleDelay, AngleDisturbance>;

/// The catalogue of a plant family: a new family is one more list, and one entry here.
[[nodiscard]] constexpr std::span<const EffectInfo* const> EffectsOf(PlantKind plant) noexcept {
  switch (plant) {
    case PlantKind::kHuntCrossley: return ContactEffects::kInfos;
    case PlantKind::kSoftActuator: return ActuatorEffects::kInfos;
    case PlantKind::kDescribed: break;
  }
  return {};
}

/// The effect with that name in the catalogue of the plant, null if there is none.
[[nodiscard]] constexpr const EffectInfo* FindEffect(PlantKind plant, std::string_view name) noexcept {
  for (const EffectInfo* info : EffectsOf(plant))
    if (info->name == name) return info;
  return nullptr;
}

/// How samples become features, by index into ContactEffects.
inline constexpr std::array<EffectFeatureFn, ContactEffects::kSize> kContactFeatures = [] {
  std::array<EffectFeatureFn, ContactEffects::kSize> features{};
  ContactEffects::ForEach(
      [&]<class E>(std::type_identity<E>, std::size_t i) { features[i] = effect_detail::FeatureOf<E>(); });
  return features;
}();

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
