#pragma once

#include <vector>

#include "armcmc/gap/types.hpp"

namespace armcmc::gap {

/// Predicted output and its derivative by every coordinate of a hypothesis.
struct Prediction {
  Vector y;         ///< [row]
  Matrix jacobian;  ///< [row][coordinate]
  /// The part of the law that does not depend on rates (the elastic force of a contact), for effects that remember it.
  Vector elastic;
  Matrix elastic_jacobian;
};

struct EffectForm;

/// What effects change before the law is evaluated.
struct LawInput {
  Vector shift;  ///< Subtracted from what the law acts on: position, pressure. Empty: nothing.
  Vector gain;   ///< Factor of the law's first parameter. Empty: one.
  /// Derivatives of the two: which coordinate, and by how much each row moves.
  struct Slope {
    int coordinate;
    Vector rows;
  };
  std::vector<Slope> shift_slopes, gain_slopes;
  Vector drive;  ///< Added to the input that drives the plant (the opening of a valve). Empty: nothing.
  std::vector<Slope> drive_slopes;

  /// An effect that acts on the state of the law's own simulation; the law fills its columns.
  struct Force {
    const EffectForm* form;
    const double* coordinates;
    int first;    ///< Column of its first coordinate.
    Vector gate;  ///< [row]
  };
  std::vector<Force> forces;
};

}  // namespace armcmc::gap
