#pragma once

#include "armcmc/gap/result.hpp"

namespace armcmc::gap::test {

/// A result with plausible numbers, as if 20 s of contact had been analysed, the last 6 s held out.
/// kNamed: Coulomb friction. kAmbiguous: delay or lag. kUnnamed: a slip that no effect describes. kNone: noise alone.
[[nodiscard]] Result ExampleResult(Verdict verdict);

}  // namespace armcmc::gap::test
