#pragma once

#include "armcmc/gap/effect_form.hpp"

namespace armcmc::gap {

/// A variable on which a law depends, with the range over which its error may vary.
struct LawVariable {
  Role role;
  double low, high;
  bool saturates = false;  ///< Transformed by tanh(value / high): finest near zero, where most of the data are.
};

/// Model error of a law: a smooth factor that depends on the variables of the law, a sum of wide basis functions of
/// about ten percent. It is never named, and scores treat it as known: leaving out the block with the deepest press
/// would only show that the basis functions do not extrapolate.
///
/// Kennedy and O'Hagan (2001) give the discrepancy of a model the same variables as the model; Brynjarsdottir and
/// O'Hagan (2014) show that parameters are wrong without it. Effects are distinguished from it by what it cannot
/// represent: forces out of contact, memory, jumps, and changes with time. A law whose effects are smooth functions of
/// the same variables (the valve flow) has no such term, because it would absorb them.
/// @param places  Basis functions along each variable.
[[nodiscard]] EffectForm LawErrorForm(const LawVariable& a, const LawVariable& b, int places);

}  // namespace armcmc::gap
