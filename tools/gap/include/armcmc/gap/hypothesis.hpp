#pragma once

#include <string>
#include <vector>

#include "armcmc/gap/equation.hpp"
#include "armcmc/gap/prediction.hpp"

namespace armcmc::gap {

/// An effect in a hypothesis: which formula, and when it acts.
struct Term {
  const EffectForm* form = nullptr;
  When when;
};

/// The base law with effects. Coordinates: those of the law, then those of each term in order.
struct Hypothesis {
  std::vector<Term> terms;
};

/// 1 where the gate is open, 0 where it is closed.
[[nodiscard]] Vector GateOf(const When& when, const Signals& signals);
/// "coulomb_friction", "force_bias from 4.25 s".
[[nodiscard]] std::string TermText(const Term& term);
[[nodiscard]] std::vector<Coordinate> CoordinatesOf(const Equation& equation, const Signals& signals,
                                                    const Hypothesis& hypothesis);

/// Whether the last term adds its features to the output and nothing else: they depend on no other coordinate.
[[nodiscard]] bool LastOnlyAdds(const Hypothesis& hypothesis);
/// Features of a term, gate included: [row][amplitude].
[[nodiscard]] Matrix Features(const Signals& signals, const Term& term, const double* shapes);

/// The last prediction of the law alone, kept because a grid over an effect evaluates it repeatedly at the same
/// coordinates.
struct LawMemo {
  Vector theta;              ///< Coordinates of the law. Empty: no prediction is stored.
  bool with_slopes = false;  ///< Whether its derivatives are stored.
  Prediction law;
};

/// Prediction and exact derivatives; law and effects propagate the columns of earlier slots.
/// @param wanted  Requested derivatives; the others may be left out.
/// @param memo    For this equation and these signals only; may be null.
[[nodiscard]] Prediction Evaluate(const Equation& equation, const Signals& signals, const Hypothesis& hypothesis,
                                  const Vector& theta, Slopes wanted = {}, LawMemo* memo = nullptr);

}  // namespace armcmc::gap
