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

/// 1 where the gate is open, 0 where it is shut.
[[nodiscard]] Vector GateOf(const When& when, const Signals& signals);
/// "coulomb_friction", "force_bias from 4.25 s".
[[nodiscard]] std::string TermText(const Term& term);
[[nodiscard]] std::vector<Coordinate> CoordinatesOf(const Equation& equation, const Signals& signals,
                                                    const Hypothesis& hypothesis);

/// Whether the last term adds its features to the output and nothing else: they depend on no other coordinate.
[[nodiscard]] bool LastOnlyAdds(const Hypothesis& hypothesis);
/// Features of a term, gate included: [row][amplitude].
[[nodiscard]] Matrix Features(const Signals& signals, const Term& term, const double* shapes);

/// What the law by itself said last. A grid over an effect asks it again and again for one set of its coordinates.
struct LawMemo {
  Vector theta;              ///< Of the law alone. Empty: nothing is known.
  bool with_slopes = false;  ///< Whether its derivatives were asked for.
  Prediction law;
};

/// Prediction and exact derivatives: law and effects pass the columns of the slots before them on.
/// @param wanted  Derivatives that are asked for; every one of the others may be left out.
/// @param memo    Of this equation and these signals; may be null.
[[nodiscard]] Prediction Evaluate(const Equation& equation, const Signals& signals, const Hypothesis& hypothesis,
                                  const Vector& theta, Slopes wanted = {}, LawMemo* memo = nullptr);

}  // namespace armcmc::gap
