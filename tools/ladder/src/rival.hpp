#pragma once

#include <string>

namespace armcmc::ladder {

/// An explanation outside the catalogue that rules out an effect.
struct Rival {
  std::string as_if;  ///< "K followed w by a curve"
  std::string why;    ///< "leaves 4.5 times less squared error on data left out, and has another shape"
};

}  // namespace armcmc::ladder
