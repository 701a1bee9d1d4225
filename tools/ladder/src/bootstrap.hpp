#pragma once

#include "armcmc/ladder/climb.hpp"

namespace armcmc::ladder {

/// Sets gain_share and win_share, by a bootstrap over the short segments.
void Bootstrap(Rung* rung);

/// Fraction of bootstrap samples in which the first of those named is the best of them.
[[nodiscard]] double ShareOfFirst(const Rung& rung);

/// Fraction of the bootstrap samples in which a family of those named has the smallest error of all that were compared.
[[nodiscard]] double WinShare(const Rung& rung);

}  // namespace armcmc::ladder
