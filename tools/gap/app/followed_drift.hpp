#pragma once

#include <string>

#include "armcmc/gap/result.hpp"
#include "armcmc/replay/pack_source.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::gap {

/// The estimator run over a recording for which the offline diagnosis finds a gap.
struct FollowedDrift {
  /// Drift is probable in most packs, and the gap watch has run long enough and detects nothing else.
  bool followed = false;
  double share = 0.0;  ///< Share of the packs with data in which drift is more probable than not.
  std::string rates;   ///< Mean rates over those packs: "K 0.06 N/m^p per s, ...".
};

/// @param packs  Source and length of the packs; the plant is filled in.
/// @throws support::InputError if the recording contains no complete pack.
[[nodiscard]] FollowedDrift FollowDrift(const EstimatorSettings& base, const replay::SourceRequest& packs);

/// Changes the verdict `unnamed` to `none` if the gap is a drift that the estimator tracks.
void AttributeToDrift(const FollowedDrift& drift, Result* result);

}  // namespace armcmc::gap
