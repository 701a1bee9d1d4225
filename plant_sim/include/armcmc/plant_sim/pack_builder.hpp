#pragma once

#include <cstdint>

#include "armcmc/data_pack_t.hpp"
#include "armcmc/plant_sim/simulation.hpp"
#include "armcmc/plant_truth_t.hpp"

namespace armcmc::plant_sim {

/// Fills packs from a simulation. Pack k holds samples S (k-1) + 1 .. S (k-1) + N, S = Scenario::stride(); sample 0 is
/// in no pack.
class PackBuilder {
 public:
  PackBuilder(const Scenario& scenario, std::uint64_t seed, std::int64_t run_id);

  /// Simulates the next pack and fills everything but the stamps of the clocks. False when the plant left the
  /// finite range; the messages are then unusable. @rt No heap, no lock, no throw.
  [[nodiscard]] bool Next() noexcept;
  /// Stamps both messages: CLOCK_MONOTONIC of the last sample, CLOCK_REALTIME of the sending.
  void Stamp(std::int64_t t_last_ns, std::int64_t utime) noexcept;

  [[nodiscard]] const data_pack_t& pack() const noexcept { return pack_; }
  [[nodiscard]] const plant_truth_t& truth() const noexcept { return truth_; }

 private:
  Simulation simulation_;
  int stride_;
  const PlantFamily& family_;
  data_pack_t pack_{};
  plant_truth_t truth_{};
};

}  // namespace armcmc::plant_sim
