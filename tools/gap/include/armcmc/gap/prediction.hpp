#pragma once

#include <limits>
#include <vector>

#include "armcmc/gap/types.hpp"

namespace armcmc::gap {

/// Coordinates whose derivatives are asked for.
struct Slopes {
  int first = 0;
  int end = std::numeric_limits<int>::max();

  [[nodiscard]] static Slopes None() { return {0, 0}; }
  [[nodiscard]] bool Has(int coordinate) const { return coordinate >= first && coordinate < end; }
  /// Whether no coordinate before this one is asked for.
  [[nodiscard]] bool NoneBelow(int coordinate) const { return first >= end || first >= coordinate; }
};

/// Predicted output and its derivative by the coordinates of a hypothesis.
struct Prediction {
  Vector y;         ///< [row]
  Slopes wanted;    ///< Of the columns below; others may be left at zero where they cost something, and
                    ///< where none is asked for there need not be any.
  Matrix jacobian;  ///< [row][coordinate]
  /// The part of the law that does not depend on rates (the elastic force of a contact), for effects that remember it.
  Vector elastic;
  Matrix elastic_jacobian;  ///< Of no columns where no effect remembers.
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
