#include "armcmc/stress/verdict.hpp"

namespace armcmc::stress {

std::int64_t AllowedOwnMisses(const PhaseResult& phase) {
  return phase.report["period_ms"].get<double>() >= 10.0 ? 0 : phase.report["steps"].get<std::int64_t>() / 10'000;
}

std::string Verdict::Text() const {
  if (passed) return "passed";
  std::string text = "failed: ";
  for (std::size_t i = 0; i < reasons.size(); ++i) text += (i == 0 ? "" : "; ") + reasons[i];
  return text;
}

std::vector<FaultTally> AllFaults(const std::vector<PhaseResult>& phases) {
  std::vector<FaultTally> all;
  for (const FaultSpec& fault : FaultCatalog()) {
    FaultTally sum;
    sum.fault = &fault;
    for (const PhaseResult& phase : phases) {
      for (const FaultTally& tally : phase.faults) {
        if (tally.fault != &fault) continue;
        sum.injected += tally.injected;
        sum.detected += tally.detected;
        sum.swallowed += tally.swallowed;
        if (tally.recovered_steps > sum.recovered_steps) sum.hindrance = tally.hindrance;
        sum.recovered_steps = std::max(sum.recovered_steps, tally.recovered_steps);
        sum.stalled_steps += tally.stalled_steps;
        sum.own_misses += tally.own_misses;
        sum.flags |= tally.flags;
      }
    }
    if (sum.injected + sum.swallowed > 0) all.push_back(sum);
  }
  return all;
}

Verdict Judge(const std::vector<PhaseResult>& phases) {
  Verdict verdict;
  const auto fail = [&verdict](const std::string& reason) {
    verdict.passed = false;
    verdict.reasons.push_back(reason);
  };
  for (const PhaseResult& phase : phases) {
    const std::string under = " under load " + phase.load;
    if (!phase.trouble.empty()) {
      fail(phase.trouble + under);
      continue;
    }
    if (phase.own_misses_outside > AllowedOwnMisses(phase)) {
      fail(std::to_string(phase.own_misses_outside) + " own misses outside of faults" + under);
    }
    for (const auto& [stage, count] : phase.report["allocations"].items())
      if (count.is_number() && count != 0) fail(count.dump().append(" heap calls in ").append(stage).append(under));
  }
  for (const FaultTally& fault : AllFaults(phases)) {
    const std::string name = fault.fault->name;
    if (fault.detected < fault.injected) {
      fail(name + " detected " + std::to_string(fault.detected) + " of " + std::to_string(fault.injected));
    }
    if (fault.recovered_steps > kMostRecoverySteps) {
      const std::string steps = fault.recovered_steps >= FaultJudge::kNever
                                    ? " did not recover in time"
                                    : ": recovered after " + std::to_string(fault.recovered_steps) + " steps";
      fail(name + steps + " (" + fault.hindrance + ")");
    }
  }
  return verdict;
}

}  // namespace armcmc::stress
