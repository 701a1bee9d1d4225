#pragma once

#include <array>
#include <cstdint>

#include "armcmc/change_t.hpp"
#include "armcmc/estimate_t.hpp"
#include "armcmc/estimator_status_t.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/posterior_t.hpp"
#include "armcmc/rt/counters.hpp"
#include "armcmc/rt/deadline_monitor.hpp"
#include "armcmc/rt/hand_over.hpp"
#include "armcmc/rt/settings.hpp"
#include "armcmc/rt/step_engine.hpp"

namespace armcmc::rt {

/// Fills estimate_t from the output of a step. Sets every field.
void FillEstimate(const StepOutput& output, const StepEngine& engine, std::int64_t utime,
                  estimate_t* message) noexcept ARMCMC_NONBLOCKING;

/// Fills posterior_t: the marginals of the reported mode. Sets every field.
void FillPosterior(const StepOutput& output, const StepEngine& engine, std::int64_t utime,
                   posterior_t* message) noexcept ARMCMC_NONBLOCKING;

/// Fills change_t: probabilities of change and drift rates of each mode. Sets every field.
void FillChange(const StepOutput& output, const StepEngine& engine, std::int64_t utime,
                change_t* message) noexcept ARMCMC_NONBLOCKING;

/// What a status message needs beyond the counters.
struct StatusContext {
  std::int64_t utime = 0;
  Nanos now_ns = 0;
  const StepOutput* output = nullptr;  ///< The step of this period; nullptr when there was none.
  Nanos witness_max_ns = 0;
  std::int32_t fault_flags = 0;
  std::int32_t degraded_flags = 0;
  GapState gap;
};

/// Fills estimator_status_t. Sets every field; the times of the stages are zero without a step.
void FillStatus(const StatusContext& context, const RtSettings& settings, const Counters& counters,
                const DeadlineMonitor& monitor, estimator_status_t* message) noexcept ARMCMC_NONBLOCKING;

}  // namespace armcmc::rt
