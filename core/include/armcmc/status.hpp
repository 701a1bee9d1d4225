#pragma once

#include <cstdint>
#include <string_view>

namespace armcmc {

/// Outcome of a function on the step path. Such functions never throw. They set their outputs as documented for each
/// value, and leave the estimator in a valid state in every case: the next pack can be processed.
///
/// kOk, kTruncated and kHeld are normal operation. After kBadPack and kNonFinite the pipeline raises the fault flag for
/// numeric trouble, records the number in the event log, and continues with the next pack. On the bus, estimate_t has
/// `truncated`, and the modes that a pack did not update keep what they had.
enum class Status : std::uint8_t {
  kOk = 0,     ///< Every active mode has a new posterior.
  kTruncated,  ///< The deadline cut the number of draws; the result is valid, with fewer draws.
  kHeld,       ///< The pack carries no information about the parameters; the posterior is kept.
  kBadPack,    ///< The pack violates its contract; nothing was changed.
  kNonFinite,  ///< No draw had a finite posterior density; the previous posterior is kept.
};

/// Name of a status for messages and reports, "truncated". @rt No heap, no lock, no throw.
[[nodiscard]] constexpr std::string_view ToString(Status status) noexcept {
  switch (status) {
    case Status::kOk: return "ok";
    case Status::kTruncated: return "truncated";
    case Status::kHeld: return "held";
    case Status::kBadPack: return "bad pack";
    case Status::kNonFinite: return "non-finite";
  }
  return "unknown";
}

}  // namespace armcmc
