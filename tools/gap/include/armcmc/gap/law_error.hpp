#pragma once

#include "armcmc/gap/effect_form.hpp"

namespace armcmc::gap {

/// What a law depends on, with the range over which its error may change.
struct LawVariable {
  Role role;
  double low, high;
  bool saturates = false;  ///< By tanh(value / high): where most of the data lie near zero, there it may change most.
};

/// What a law may differ from its formula by: a smooth factor of what the law depends on, a sum of wide bumps of some
/// ten percent. It is never named, and scores take it as known: a block that holds the deepest press, left out, would
/// only say that bumps do not extrapolate.
///
/// Kennedy and O'Hagan (2001) give the discrepancy of a model the same variables as the model; Brynjarsdottir and
/// O'Hagan (2014) show that parameters are wrong without it. Effects are told from it by what it cannot do: act out of
/// contact, remember, jump, or change with time. A law whose effects are smooth functions of the same variables (the
/// valve flow's) has none: it would take their names.
[[nodiscard]] EffectForm LawErrorForm(const LawVariable& a, const LawVariable& b);

}  // namespace armcmc::gap
