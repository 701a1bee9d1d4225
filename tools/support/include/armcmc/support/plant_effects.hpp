#pragma once

#include <string>
#include <vector>

#include "armcmc/plant/effect.hpp"
#include "armcmc/support/effect_request.hpp"
#include "armcmc/support/strict_toml.hpp"

namespace armcmc::support {

/// What a plant file says of effects.
///
///   [effects]
///   use = ["coulomb_friction", { name = "linear_loss", bind = { x = "high" }, c = { mean = 0.01, sd = 0.01 } }]
///   without = ["inertia"]
///   [[effect]]              an entry as in the catalogue, without `schema`
struct PlantEffects {
  std::vector<EffectRequest> use;    ///< In the plant: added in this order.
  std::vector<std::string> without;  ///< Not to be looked for.
  std::vector<EffectEntry> own;      ///< Stand before those of the catalogue that are called alike.
};

/// @param root  Of the plant file. Its Finish() is left to the caller.
/// @throws ConfigError.
[[nodiscard]] PlantEffects ReadPlantEffects(StrictTable root);

/// The effects that a plant file may speak of: its own, then the catalogue without those that they replace.
[[nodiscard]] std::vector<EffectEntry> EffectsFor(const PlantEffects& effects);

}  // namespace armcmc::support
