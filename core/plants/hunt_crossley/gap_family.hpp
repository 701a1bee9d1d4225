#pragma once

#include "armcmc/gap_watch/gap_checks.hpp"

namespace armcmc {

/// What the gap watch looks for in the errors of the contact law, free motion included.
[[nodiscard]] const GapFamily& ContactGapFamily() noexcept;

}  // namespace armcmc
