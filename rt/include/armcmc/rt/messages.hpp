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

/// Fills estimate_t, the channel EST_ESTIMATE, from the output of a step. Sets every field; parameters and modes beyond
/// those of the plant are zero. Units are those of the plant, see estimate_t.
/// @param output   The finished step.
/// @param engine   Names and units.
/// @param utime    CLOCK_REALTIME in microseconds, for the alignment of logs.
/// @param[out] message  All fields.
/// @rt No heap, no lock, no throw.
void FillEstimate(const StepOutput& output, const StepEngine& engine, std::int64_t utime,
                  estimate_t* message) noexcept ARMCMC_NONBLOCKING;

/// Fills posterior_t, the channel EST_POSTERIOR: marginal histograms of the parameters of the reported mode. Sets every
/// field; parameters as above.
/// @rt No heap, no lock, no throw. O(bins).
void FillPosterior(const StepOutput& output, const StepEngine& engine, std::int64_t utime,
                   posterior_t* message) noexcept ARMCMC_NONBLOCKING;

/// Fills change_t, the channel EST_CHANGE: for each mode the probabilities that the parameters changed, drifted or
/// stayed, and the drift rates with their standard deviations, in units of the parameter per second. Sets every field.
/// @rt No heap, no lock, no throw.
void FillChange(const StepOutput& output, const StepEngine& engine, std::int64_t utime,
                change_t* message) noexcept ARMCMC_NONBLOCKING;

/// Content of a status message that is not in the counters.
struct StatusContext {
  std::int64_t utime = 0;              ///< CLOCK_REALTIME, microseconds.
  Nanos now_ns = 0;                    ///< CLOCK_MONOTONIC, ns.
  const StepOutput* output = nullptr;  ///< The step of this period; nullptr when there was none.
  Nanos witness_max_ns = 0;            ///< Longest delay of a witness thread since the last status, ns.
  std::int32_t fault_flags = 0;        ///< FAULT_* bits of this period.
  std::int32_t degraded_flags = 0;     ///< DEGRADED_* bits: real-time measures not in effect.
  GapState gap;                        ///< State of the gap watch after the newest step.
};

/// Fills estimator_status_t, the channel EST_STATUS: counters since the start, flags of this period, stage times of
/// this step in ns. Sets every field; the stage times are zero without a step.
/// @rt No heap, no lock, no throw.
void FillStatus(const StatusContext& context, const RtSettings& settings, const Counters& counters,
                const DeadlineMonitor& monitor, estimator_status_t* message) noexcept ARMCMC_NONBLOCKING;

}  // namespace armcmc::rt
