#pragma once

#include <array>

#include "armcmc/nonblocking.hpp"
#include "armcmc/settings.hpp"
#include "plants/soft_actuator/effects.hpp"

namespace armcmc {

/// How the valve flow predicts the pressure rate: the constants of the law, and the effects that the settings add,
/// where their amplitudes stand and when they act.
struct FlowPlan {
  struct Term {
    int parameter = -1;  ///< Index of its amplitude among the parameters; negative: the effect is not there.
    EffectGate gate = EffectGate::kAlways;
    double from_s = 0.0, until_s = 0.0;

    [[nodiscard]] bool there() const noexcept { return parameter >= 0; }
    [[nodiscard]] bool ActsAt(double t_s) const noexcept ARMCMC_NONBLOCKING {
      if (gate == EffectGate::kFrom) return t_s >= from_s;
      return gate != EffectGate::kUntil || t_s < until_s;
    }
  };

  FlowPlan() = default;
  /// @param first_amplitude  Parameters before those of the effects.
  FlowPlan(const EstimatorSettings& settings, int first_amplitude);

  [[nodiscard]] const Term& lag() const noexcept { return term[FlowEffects::kIndexOf<ValveLag>]; }

  bool empty = true;        ///< The pressure rate is not what is regressed: the law has no effects.
  bool head_moves = false;  ///< See FlowPack.
  std::array<Term, FlowEffects::kSize> term;
  double p_atm = 0.0, supply = 0.0;             ///< Pa; supply is p_s - p_atm.
  double least_gain = 0.0;                      ///< See FlowPack.
  double typical_lag = 0.0, longest_lag = 0.0;  ///< Mean and upper bound of the prior of ValveLag, s.
};

}  // namespace armcmc
