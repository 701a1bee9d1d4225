#pragma once

#include <array>
#include <cstdint>

#include "armcmc/types.hpp"

namespace armcmc {

/// The parameters in which the law of a mode is linear, given the others:
///
///     F(X, theta) = f_0(X, phi) + sum_i theta_i f_i(X, phi)       i in `linear`, phi the rest
///
/// Known only where phi is one parameter at most, or two of which every f needs one at most, as in K x^p + B v x^q.
struct LinearPart {
  enum Need : std::uint8_t { kNeither = 0, kCurved = 1, kSecond = 2, kBoth = 3 };

  std::array<int, kMaxParams> linear{};
  int num_linear = 0;  ///< 0: not known to be linear in any.
  int curved = -1;     ///< Another parameter; -1: there is none.
  int second = -1;     ///< And a further one; -1: there is none.
  /// What f_0 and then the f of `linear` need of the two. Read only where there is a second.
  std::array<Need, kMaxParams + 1> needs{};

  /// What function `i` needs: 0 is f_0, 1 + k that of linear[k].
  [[nodiscard]] constexpr Need NeedOf(int i) const noexcept {
    if (second < 0) return curved < 0 ? kNeither : kCurved;
    return needs[static_cast<std::size_t>(i)];
  }
};

}  // namespace armcmc
