#pragma once

#include <memory>

#include "armcmc/effects/effect_rows.hpp"
#include "armcmc/plant/program.hpp"

namespace armcmc {

/// One pack in the form that the model of its plant needs. Depending on the kind of plant, one of the two members is
/// used. It is allocated at set-up and refilled for every pack, without a heap call.
///
/// Each AdjustResult has one, so that adjust can prepare the next pack while execute still reads the last one.
struct EffectPack {
  std::unique_ptr<CompiledPack> compiled;  ///< For a compiled plant with effects, else null; see Composition.
  PlantPack described;                     ///< For a plant described by a file; see PlantProgram.
};

}  // namespace armcmc
