#pragma once

#include <string>

#include "armcmc/gap/result.hpp"
#include "armcmc/replay/pack_source.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::gap {

/// What the estimator makes of a recording as it goes by, with the model that offline lacks something.
struct FollowedDrift {
  /// It believes in drift in most packs, and its gap watch, which has judged long enough, sees nothing beyond it.
  bool followed = false;
  double share = 0.0;  ///< Of the packs with data: drift is more probable than not.
  std::string rates;   ///< Means over those packs: "K 0.06 N/m^p per s, ...".
};

/// @param packs  Where they come from, and their length; the plant is filled in.
/// @throws support::InputError when the recording holds no whole pack.
[[nodiscard]] FollowedDrift FollowDrift(const EstimatorSettings& base, const replay::SourceRequest& packs);

/// A drift that the estimator follows is no missing effect: of an unnamed gap that is all there is nothing is left.
void TakeAsDrift(const FollowedDrift& drift, Result* result);

}  // namespace armcmc::gap
