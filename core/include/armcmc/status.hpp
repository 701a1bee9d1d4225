#pragma once

#include <cstdint>
#include <string_view>

namespace armcmc {

/// Outcome of a function on the step path. Such functions never throw. They set their outputs as documented for each
/// value, and leave the estimator in a valid state whatever the outcome: the next pack can be processed.
///
/// Published as `status` of estimate_t, as a number; the values are part of the message and do not change.
enum class Status : std::uint8_t {
  kOk = 0,
  kTruncated,           ///< The deadline cut the number of draws; the result is valid, with fewer draws.
  kHeld,                ///< The pack says nothing about the parameters; what was known is kept.
  kBadPack,             ///< The pack violates its contract; nothing was changed.
  kNonFinite,           ///< No draw had a finite posterior; what was known is kept.
  kSingularCovariance,  ///< A covariance was not positive definite; a wider one was used.
};

/// Name of a status for messages and reports, "truncated". @rt No heap, no lock, no throw.
[[nodiscard]] constexpr std::string_view ToString(Status status) noexcept {
  switch (status) {
    case Status::kOk: return "ok";
    case Status::kTruncated: return "truncated";
    case Status::kHeld: return "held";
    case Status::kBadPack: return "bad pack";
    case Status::kNonFinite: return "non-finite";
    case Status::kSingularCovariance: return "singular covariance";
  }
  return "unknown";
}

}  // namespace armcmc
