#pragma once

#include "armcmc/effects/effect.hpp"
#include "armcmc/nonblocking.hpp"

namespace armcmc {

/// What an additive effect of the contact sees of one sample.
struct EffectInput {
  double t;    ///< Plant time, s.
  double dt;   ///< Sample interval, s.
  double x;    ///< Penetration, m; negative in free motion.
  double v;    ///< Its rate, m/s.
  bool first;  ///< No sample before it: memory starts here, at rest.
};

/// How the samples of an effect become numbers that do not depend on the candidate; null where there are none.
using EffectFeatureFn = void (*)(const EffectInput&, const double* shape, double* memory,
                                 double* feature) noexcept ARMCMC_NONBLOCKING;

}  // namespace armcmc
