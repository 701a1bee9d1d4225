#pragma once

#include "armcmc/effects/contact_pack.hpp"
#include "armcmc/effects/flow_pack.hpp"
#include "armcmc/plant/program.hpp"

namespace armcmc {

/// One pack with what the model of its plant needs; that of the others is unused.
struct EffectPack {
  ContactPack contact;
  FlowPack flow;
  PlantPack described;
};

}  // namespace armcmc
