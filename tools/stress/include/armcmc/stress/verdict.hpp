#pragma once

#include <string>
#include <vector>

#include "armcmc/stress/phase.hpp"

namespace armcmc::stress {

/// Own misses that no fault explains and that are let pass: none, and one in ten thousand steps below 10 ms.
[[nodiscard]] std::int64_t AllowedOwnMisses(const PhaseResult& phase);

/// Faults after which an estimate may be two to four joint standard deviations from the one before: one in 200, none
/// below that. A posterior that goes on learning leaves its former 95 % interval by chance now and then, so that a
/// run of thousands of faults cannot do without.
[[nodiscard]] std::int64_t AllowedALittleApart(std::int64_t faults);

struct Verdict {
  bool passed = true;
  std::vector<std::string> reasons;  ///< Why not.
  [[nodiscard]] std::string Text() const;
};

/// The faults of all phases together, in the order of the catalogue.
[[nodiscard]] std::vector<FaultTally> AllFaults(const std::vector<PhaseResult>& phases);

/// Passed: the estimator lived, no more own misses than allowed, no heap call in a stage, every fault that was
/// injected was detected and got over within FaultJudge::kMostRecoverySteps steps.
[[nodiscard]] Verdict Judge(const std::vector<PhaseResult>& phases);

}  // namespace armcmc::stress
