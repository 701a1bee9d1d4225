#pragma once

#include <cstdint>
#include <functional>

#include "armcmc/plant_sim/described_pack_builder.hpp"
#include "armcmc/plant_sim/described_pack_sender.hpp"

namespace armcmc::plant_sim {

/// How playing went.
struct PlaybackResult {
  std::int64_t packs_sent = 0;
  std::int64_t packs_late = 0;  ///< Sent more than a tenth of a period, at least 1 ms, after they were due.
};

/// Sends all packs of a builder, pack k when it is due:
///
///   due(k) = start + k T_s / speed     on CLOCK_MONOTONIC, k counted on over the runs, T_s = S dt
///
/// The times are absolute, so that the grid never drifts. A stall of the machine delays packs but loses none.
/// @param speed   > 0; 2: twice as fast as the plant was.
/// @param is_stopped  Asked at least every 0.1 s and before every pack; true ends playing. Gets the packs sent.
PlaybackResult Play(DescribedPackBuilder* builder, DescribedPackSender* sender, std::int64_t start_ns, double speed,
                    const std::function<bool(std::int64_t)>& is_stopped);

}  // namespace armcmc::plant_sim
