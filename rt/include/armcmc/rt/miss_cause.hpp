#pragma once

#include <cstdint>
#include <string_view>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/stage_timeline.hpp"
#include "armcmc/types.hpp"

namespace armcmc::rt {

/// Why a deadline was missed. Values equal estimator_status_t.MISS_*.
enum class MissCause : std::uint8_t { kNone = 0, kOwn = 1, kMachine = 2, kLateData = 3 };
inline constexpr std::size_t kNumMissCauses = 4;
[[nodiscard]] std::string_view ToString(MissCause cause) noexcept ARMCMC_NONBLOCKING;

/// Exactly one cause per miss: what, had it not happened, would have let the step keep its deadline.
///
/// Late data, when that holds for the lateness of the packs alone; else the machine, when it holds for the stalls alone
/// that were seen; when it takes both, whichever cost more. Else our own: the step would have been too late on
/// a machine that never stood still and with every pack on time. What nobody saw is not guessed: in doubt it is our
/// own.
/// @param lacked_ns  By how much the deadline was missed; <= 0: it was not.
/// @param earlier    By how much the step would have been through earlier.
[[nodiscard]] constexpr MissCause Attribute(Nanos lacked_ns, const Earlier& earlier) noexcept {
  if (lacked_ns <= 0) return MissCause::kNone;
  if (earlier.without_lateness >= lacked_ns) return MissCause::kLateData;
  if (earlier.without_stalls >= lacked_ns) return MissCause::kMachine;
  if (earlier.without_both < lacked_ns) return MissCause::kOwn;
  return earlier.without_stalls > earlier.without_lateness ? MissCause::kMachine : MissCause::kLateData;
}

}  // namespace armcmc::rt
