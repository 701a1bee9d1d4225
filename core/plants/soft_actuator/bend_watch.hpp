#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "armcmc/data_pack.hpp"
#include "armcmc/gap_watch/gap_block.hpp"
#include "armcmc/gap_watch/gap_checks.hpp"
#include "armcmc/gap_watch/gap_judge.hpp"
#include "armcmc/gap_watch/gap_settings.hpp"
#include "armcmc/gap_watch/output_watch.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/settings.hpp"
#include "plants/soft_actuator/bend_motion.hpp"
#include "plants/soft_actuator/bend_predictor.hpp"

namespace armcmc {

/// Watches the bend equation: friction in the joint, a load, a late angle sensor, a wrong constant.
///
/// The angle is simulated from the measured pressure (BendMotion) since the first pack, or the first one after a loss.
/// Its errors are scored by region over blocks of kGapBlockPacks packs, shorter ones joined to kShortestPack; with no
/// parameter that is fitted there is nothing to project out. The scale of the noise is that of the differences of
/// successive errors; a misfit below kResolution of the largest angle is no gap, whatever the noise.
class BendWatch final : public OutputWatch {
 public:
  /// @param settings  Valid. @param rate  Of false alarms, see GapEvidence. @param sensor  Tells what a pressure that
  /// was measured means; outlives the watch.
  BendWatch(const EstimatorSettings& settings, double rate, const BendPredictor& sensor) noexcept;

  void Step(const DataPack& pack, const ShownEstimates& shown) noexcept ARMCMC_NONBLOCKING override;
  void Reset() noexcept ARMCMC_NONBLOCKING override;
  [[nodiscard]] const GapState& state() const noexcept ARMCMC_NONBLOCKING override { return judge_.state(); }
  [[nodiscard]] std::string_view CheckName(int check) const noexcept override;
  void Save(SnapshotWriter* out) const noexcept ARMCMC_NONBLOCKING override { judge_.Save(out); }
  void Restore(SnapshotReader* in) noexcept ARMCMC_NONBLOCKING override { judge_.Restore(in); }

 private:
  static constexpr double kShortestPack = 0.1;  ///< s: longer than coloured noise remembers.
  static constexpr double kSettle = 0.5;        ///< s after a start, until it is forgotten.
  static constexpr double kResolution = 2e-4;

  void Start(const DataPack& pack, double pressure) noexcept ARMCMC_NONBLOCKING;
  /// Adds a sample to the stretch. @param error  Measured minus predicted, rad.
  void Add(double error, double pressure) noexcept ARMCMC_NONBLOCKING;
  void EndStretch(const DataPack& pack) noexcept ARMCMC_NONBLOCKING;
  void EndBlock(const DataPack& pack) noexcept ARMCMC_NONBLOCKING;
  /// The noise of the stretch joins that of those before. @return its scale, rad.
  [[nodiscard]] double Scale() noexcept ARMCMC_NONBLOCKING;

  GapWatchSettings settings_;
  const BendPredictor& sensor_;
  BendMotion motion_;
  GapBlock block_;
  GapJudge judge_;
  BendMotion::State bend_;
  double pressure_ = 0.0;       ///< Of the last sample, Pa.
  double since_start_s_ = 0.0;  ///< Simulated.
  std::int64_t last_seq_ = 0, last_run_ = 0;
  double noise_square_ = 0.0;  ///< Mean over stretches, rad^2.
  int stretches_ = 0;          ///< Behind it.
  double largest_ = 0.0;       ///< Angle, rad.

  GapRows rows_;  ///< Of the stretch under way.
  RegionTemplates regions_{};
  int count_ = 0;         ///< Stretches of the block.
  bool follows_ = false;  ///< The stretch follows the one before.
  double begin_s_ = 0.0;  ///< Of the block.
  std::int64_t first_seq_ = 0;
};

}  // namespace armcmc
