#pragma once

#include <memory>

#include "armcmc/effects/effect_rows.hpp"
#include "armcmc/plant/program.hpp"

namespace armcmc {

/// One pack with what the model of its plant needs; that of the other kind of plant is unused.
struct EffectPack {
  std::unique_ptr<CompiledPack> compiled;  ///< Of a compiled plant with effects, else null; see Composition.
  PlantPack described;
};

}  // namespace armcmc
