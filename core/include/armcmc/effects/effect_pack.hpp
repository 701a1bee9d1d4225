#pragma once

#include "armcmc/effects/contact_pack.hpp"
#include "armcmc/effects/flow_pack.hpp"

namespace armcmc {

/// One pack with what the effects of its plant's model need; that of the other plant is unused.
struct EffectPack {
  ContactPack contact;
  FlowPack flow;
};

}  // namespace armcmc
