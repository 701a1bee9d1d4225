#pragma once

#include <cstddef>
#include <cstdint>

#include "armcmc/data_pack_v2_t.hpp"
#include "armcmc/plant_sim/sample_runs.hpp"

namespace armcmc::plant_sim {

/// Cuts the samples of a described plant into packs, run by run: pack k of a run holds its samples (k-1) S .. (k-1) S +
/// N - 1, where S = N, or fewer so that packs overlap.
///
/// Every run is a restart of the plant: seq begins at 1 again, run_id is another one, and the plant's time counts from
/// the first sample of the run. Samples at the end of a run that do not fill a pack are left out. Values are passed on
/// as they are, NaN and infinite ones included.
class DescribedPackBuilder {
 public:
  /// @param runs              Must outlive the builder.
  /// @param samples_per_pack  N.
  /// @param run_id            Of the first run; each further run has the next number.
  /// @param stride            S, a divisor of N; 0: N.
  /// @throws std::invalid_argument where N, S, the number of inputs or dt does not fit a pack, or a signal lacks
  /// samples.
  DescribedPackBuilder(const SampleRuns& runs, int samples_per_pack, std::int64_t run_id, int stride = 0);

  /// Makes the next pack, but for its stamps. @return false after the last one. @rt No heap, no lock, no throw.
  [[nodiscard]] bool Next() noexcept;
  /// @param t_last_ns ns, CLOCK_MONOTONIC at the last sample. @param utime us, CLOCK_REALTIME.
  void Stamp(std::int64_t t_last_ns, std::int64_t utime) noexcept;

  [[nodiscard]] const data_pack_v2_t& pack() const noexcept { return pack_; }
  [[nodiscard]] std::int64_t num_packs() const noexcept { return num_packs_; }  ///< Of all runs.
  [[nodiscard]] std::size_t left_out() const noexcept { return left_out_; }     ///< Samples that fill no pack.
  [[nodiscard]] double pack_period_s() const noexcept { return pack_.dt * static_cast<double>(stride_); }

 private:
  const SampleRuns& runs_;
  std::size_t samples_, stride_;
  data_pack_v2_t pack_{};
  std::size_t run_ = 0, row_ = 0;  ///< Of the next pack.
  std::int64_t num_packs_ = 0;
  std::size_t left_out_ = 0;
};

}  // namespace armcmc::plant_sim
