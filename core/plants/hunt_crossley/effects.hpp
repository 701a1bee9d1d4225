#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include "armcmc/effects/effect_list.hpp"
#include "armcmc/nonblocking.hpp"
#include "plants/hunt_crossley/effect_input.hpp"
#include "plants/hunt_crossley/effects/adhesion.hpp"
#include "plants/hunt_crossley/effects/contact_offset.hpp"
#include "plants/hunt_crossley/effects/coulomb_friction.hpp"
#include "plants/hunt_crossley/effects/force_bias.hpp"
#include "plants/hunt_crossley/effects/force_drift.hpp"
#include "plants/hunt_crossley/effects/inertia.hpp"
#include "plants/hunt_crossley/effects/periodic_disturbance.hpp"
#include "plants/hunt_crossley/effects/presliding_friction.hpp"
#include "plants/hunt_crossley/effects/sensor_delay.hpp"
#include "plants/hunt_crossley/effects/sensor_lag.hpp"
#include "plants/hunt_crossley/effects/sensor_saturation.hpp"
#include "plants/hunt_crossley/effects/stiffness_drift.hpp"
#include "plants/hunt_crossley/effects/stress_relaxation.hpp"
#include "plants/hunt_crossley/effects/viscous_friction.hpp"

namespace armcmc {

/// Every effect of the contact. The index into this list identifies an effect.
///
/// An effect is one header in effects/ with a struct that has `static constexpr EffectInfo kInfo`, and by its slot:
///   additive          static void Feature(const EffectInput&, const double* shape, double* memory, double* feature)
///   constitutive law  static double Elapsed(const EffectInput&, const double* shape)
///   any other slot    template <class S> static typename S::V ..., per candidate (see its header)
using ContactEffects = EffectList<ForceBias, ForceDrift, CoulombFriction, PreslidingFriction, ViscousFriction, Inertia,
                                  SensorDelay, SensorLag, StressRelaxation, Adhesion, ContactOffset, SensorSaturation,
                                  PeriodicDisturbance, StiffnessDrift>;

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

/// How samples become features, by index into ContactEffects.
inline constexpr std::array<EffectFeatureFn, ContactEffects::kSize> kContactFeatures = [] {
  std::array<EffectFeatureFn, ContactEffects::kSize> features{};
  ContactEffects::ForEach(
      [&]<class E>(std::type_identity<E>, std::size_t i) { features[i] = effect_detail::FeatureOf<E>(); });
  return features;
}();

}  // namespace armcmc
