#pragma once

#include <array>
#include <cstdint>

#include "armcmc/nonblocking.hpp"
#include "armcmc/status.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

/// The plant that a pack is from, which decides what its columns mean. A compiled plant has a number of its own, chosen
/// in its folder core/plants/NAME/ and repeated as data_pack_t.PLANT_*.
enum class PlantNumber : std::int32_t {
  kNone = 0,
  kDescribed = 3,  ///< By a plant file; `fingerprint` says which.
};

/// D^t: the measurements of one algorithm step. Rows past num_samples are not read.
struct DataPack {
  std::int64_t seq = 0;     ///< Pack number, >= 1. Also selects the random stream of the step.
  std::int64_t run_id = 0;  ///< Run of the plant.
  Nanos t_last_ns = 0;      ///< Sender's CLOCK_MONOTONIC at the last sample.
  double t_last_s = 0.0;    ///< Plant time of the last sample, s.
  double dt = 0.0;          ///< Sample interval T, s, > 0.
  PlantNumber plant = PlantNumber::kNone;
  std::uint64_t fingerprint = 0;  ///< Plant::fingerprint() of a described plant.
  /// The samples of the pack seq + seq_step follow the last one of this: 1, or as many packs as share a sample
  /// (EstimatorSettings::overlap). An estimator sets it in what it hands on.
  int seq_step = 1;
  int num_samples = 0;                      ///< [1, kMaxPackSamples].
  int num_inputs = 0;                       ///< [1, kMaxPackInputs].
  std::array<double, kMaxPackSamples> y{};  ///< Output, in its unit.
  std::array<std::array<double, kMaxPackInputs>, kMaxPackSamples>
      u{};  ///< The plant's signals without its output, in their order and units.

  /// kOk, or kBadPack when seq or a count is out of range, dt is not positive, or a used value is not finite.
  /// @rt No heap, no lock, no throw. O(n).
  [[nodiscard]] Status Validate() const noexcept ARMCMC_NONBLOCKING;
};

}  // namespace armcmc
