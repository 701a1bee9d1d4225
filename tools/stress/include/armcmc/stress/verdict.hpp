#pragma once

#include <string>
#include <vector>

#include "armcmc/stress/phase.hpp"

namespace armcmc::stress {

/// Own misses that no fault explains and that are let pass: none, and one in ten thousand steps below 10 ms.
[[nodiscard]] std::int64_t AllowedOwnMisses(const PhaseResult& phase);

struct Verdict {
  bool passed = true;
  std::vector<std::string> reasons;  ///< Why not.
  [[nodiscard]] std::string Text() const;
};

/// The faults of all phases together, in the order of the catalogue.
[[nodiscard]] std::vector<FaultTally> AllFaults(const std::vector<PhaseResult>& phases);

/// Passed: the estimator lived, no more own misses than allowed, no heap call in a stage, every fault that was
/// injected was detected, and all was normal again within kMostRecoverySteps steps.
[[nodiscard]] Verdict Judge(const std::vector<PhaseResult>& phases);

}  // namespace armcmc::stress
