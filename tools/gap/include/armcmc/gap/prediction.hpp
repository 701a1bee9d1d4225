#pragma once

#include <limits>
#include <vector>

#include "armcmc/gap/types.hpp"

namespace armcmc::gap {

/// Coordinates whose derivatives are requested.
struct Slopes {
  int first = 0;
  int end = std::numeric_limits<int>::max();

  [[nodiscard]] static Slopes None() { return {0, 0}; }
  [[nodiscard]] bool Has(int coordinate) const { return coordinate >= first && coordinate < end; }
  /// Whether no coordinate before this one is asked for.
  [[nodiscard]] bool NoneBelow(int coordinate) const { return first >= end || first >= coordinate; }
};

/// Predicted output and its derivatives with respect to the coordinates of a hypothesis.
struct Prediction {
  Vector y;  ///< [row]
  Slopes
      wanted;  ///< Valid columns of the jacobian; others may be zero, and if none is wanted there need be no columns.
  Matrix jacobian;  ///< [row][coordinate]
  /// The part of the law that does not depend on rates (the elastic force of a contact), for effects with memory of it.
  Vector elastic;
  Matrix elastic_jacobian;  ///< Without columns if no effect has memory.
};

struct EffectForm;

/// The changes that effects make before the law is evaluated.
struct LawInput {
  Vector shift;  ///< Subtracted from the variable of the law: position, pressure. Empty: zero.
  Vector gain;   ///< Factor of the law's first parameter. Empty: one.
  /// Derivatives of the two: the coordinate, and the derivative of each row.
  struct Slope {
    int coordinate;
    Vector rows;
  };
  std::vector<Slope> shift_slopes, gain_slopes;
  Vector drive;  ///< Added to the input that drives the plant (the opening of a valve). Empty: zero.
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
