#pragma once

#include <cstdint>
#include <string_view>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/stage_timeline.hpp"
#include "armcmc/types.hpp"

namespace armcmc::rt {

/// Cause of a missed deadline. The values are those of estimator_status_t.MISS_*.
enum class MissCause : std::uint8_t {
  kNone = 0,      ///< The deadline was kept.
  kOwn = 1,       ///< The estimator itself took too long.
  kMachine = 2,   ///< Stalls of the machine: hypervisor, firmware or kernel.
  kLateData = 3,  ///< The pack came late.
};
/// Number of values, kNone included.
inline constexpr std::size_t kNumMissCauses = 4;
/// Name for reports, "late data".
[[nodiscard]] std::string_view ToString(MissCause cause) noexcept ARMCMC_NONBLOCKING;

/// Exactly one cause per miss: the one without which the step would have met its deadline.
///
/// Late data, if removing the lateness of the packs alone would have been enough; otherwise the machine, if removing
/// the observed stalls alone would have been enough; if it takes both, the larger of the two. Otherwise own: the step
/// would have been too late on a machine without stalls and with every pack on time. Stalls without evidence are not
/// assumed: in doubt a miss is own.
/// @param lacked_ns  By how much the deadline was missed; <= 0: it was not.
/// @param earlier    By how much earlier the step would have finished.
[[nodiscard]] constexpr MissCause Attribute(Nanos lacked_ns, const Earlier& earlier) noexcept {
  if (lacked_ns <= 0) return MissCause::kNone;
  if (earlier.without_lateness >= lacked_ns) return MissCause::kLateData;
  if (earlier.without_stalls >= lacked_ns) return MissCause::kMachine;
  if (earlier.without_both < lacked_ns) return MissCause::kOwn;
  return earlier.without_stalls > earlier.without_lateness ? MissCause::kMachine : MissCause::kLateData;
}

}  // namespace armcmc::rt
