#pragma once

#include <cstdint>

#include "armcmc/data_pack.hpp"

namespace armcmc {

/// Which pack was the last: whether what it has left holds for the next one.
struct LastPack {
  std::int64_t seq = -1, run_id = 0;
  double dt = 0.0;
  [[nodiscard]] static LastPack Of(const DataPack& pack) noexcept { return {pack.seq, pack.run_id, pack.dt}; }
  /// The next of the same run whose samples follow the last one at the same interval: the memory is valid.
  [[nodiscard]] bool ContinuesWith(const DataPack& pack) const noexcept {
    return seq >= 0 && pack.seq == seq + pack.seq_step && pack.run_id == run_id && pack.dt == dt;
  }
};

}  // namespace armcmc
