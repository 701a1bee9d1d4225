#pragma once

#include <optional>

#include "armcmc/ladder/climb.hpp"
#include "rival.hpp"

namespace armcmc::ladder {

/// The motion as a rival of a disturbance at one frequency, which acts whatever the plant does.
///
/// What the law lacks repeats with the motion, and a motion to and fro has a frequency: friction and a spring together
/// look like a sine in time. The recording can say that the motion is not the cause only if no function of the motion
/// predicts the disturbance.
/// @return a rival if the flexible function of the features, fitted to what the effect adds, predicts more than half of
///   its square on the segments that are left out; empty for other effects.
/// @param base  The model that the effect extends.
[[nodiscard]] std::optional<Rival> MotionRivalOf(const View& view, const Trial& base, const Contender& c);

}  // namespace armcmc::ladder
