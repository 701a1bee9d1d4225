#pragma once

#include <array>

#include "armcmc/effects/adhesion.hpp"
#include "armcmc/effects/contact_offset.hpp"
#include "armcmc/effects/coulomb_friction.hpp"
#include "armcmc/effects/force_bias.hpp"
#include "armcmc/effects/force_drift.hpp"
#include "armcmc/effects/inertia.hpp"
#include "armcmc/effects/periodic_disturbance.hpp"
#include "armcmc/effects/presliding_friction.hpp"
#include "armcmc/effects/sensor_delay.hpp"
#include "armcmc/effects/sensor_lag.hpp"
#include "armcmc/effects/sensor_saturation.hpp"
#include "armcmc/effects/stiffness_drift.hpp"
#include "armcmc/effects/stress_relaxation.hpp"
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
  static constexpr std::array<EffectFeatureFn, sizeof...(Effects)> kFeatures{effect_detail::FeatureOf<Effects>()...};
};

/// Every effect of the contact plant. The index into this list identifies an effect.
using AllEffects = EffectList<ForceBias, ForceDrift, CoulombFriction, PreslidingFriction, ViscousFriction, Inertia,
                              SensorDelay, SensorLag, StressRelaxation, Adhesion, ContactOffset, SensorSaturation,
                              PeriodicDisturbance, StiffnessDrift>;

/// Index of the effect with that name, -1 if there is none.
[[nodiscard]] constexpr int FindEffect(std::string_view name) noexcept {
  for (int i = 0; i < AllEffects::kSize; ++i)
    if (AllEffects::kInfos[static_cast<std::size_t>(i)]->name == name) return i;
  return -1;
}

}  // namespace armcmc
