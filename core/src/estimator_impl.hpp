#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "armcmc/adjust_result.hpp"
#include "armcmc/baselines/pack_filter.hpp"
#include "armcmc/effects/composition.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/gap_watch/gap_watch.hpp"
#include "armcmc/gap_watch/output_watch.hpp"
#include "armcmc/mode_sampler.hpp"
#include "armcmc/models/compiled_plant.hpp"
#include "armcmc/output_predictor.hpp"
#include "armcmc/plant/output_trajectory.hpp"
#include "armcmc/plant/state_filter.hpp"
#include "armcmc/summary.hpp"

namespace armcmc {

/// Two memories of a mode: one read while the other is written, so that a failed step leaves the posterior untouched.
struct ModeMemory {
  PosteriorMemory slot[2];
  int current = 0;
};

/// State of the estimator, by the stage that owns it. Adjust is in estimator.cpp, execute in estimator_execute.cpp,
/// snapshots in estimator_snapshot.cpp.
struct Estimator::Impl {
  /// @param lender  Lends its scratch; null: own scratch. @throws std::invalid_argument from settings.Validate().
  Impl(const EstimatorSettings& s, const Impl* lender);

  /// The estimates shown before the first pack: the prior's mean if it predicts the output, else none.
  void ReportPrior() noexcept ARMCMC_NONBLOCKING;
  void PrepareMode(const DataPack& pack, const EffectPack& effects, int mode,
                   ModeData* data) const noexcept ARMCMC_NONBLOCKING;

  EstimatorSettings settings;
  int model;
  Composition composition;
  const ModelInfo& info;
  const simd::Kernels& kernels;
  int dim = 0;

  /// One step of mode m with the method of the settings.
  Status DrawMode(std::size_t m, std::uint64_t pack, Nanos deadline_ns, ClockRef clock, int limit,
                  AdjustResult* result) noexcept ARMCMC_NONBLOCKING;
  /// Propagates the posterior of mode m over a pack without information about it.
  void Wait(std::size_t m, bool acts) noexcept ARMCMC_NONBLOCKING;
  /// The work that the newest DrawMode() deferred, if any.
  void Remember(ClockRef clock) noexcept ARMCMC_NONBLOCKING;
  /// Estimates the initial states of a described plant, with their uncertainty, before a pack is drawn.
  void ExpectStates(AdjustResult* result) noexcept ARMCMC_NONBLOCKING;
  /// Integrates the states of a described plant to the end of the pack, for the mean of the posterior after it.
  void CarryStates() noexcept ARMCMC_NONBLOCKING;
  void ForgetStates() noexcept ARMCMC_NONBLOCKING;
  /// A baseline with a single parameter vector reports it for every mode.
  void ShareVector(Estimate* e) noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] bool one_vector() const noexcept {
    return settings.method != Method::kArmcmc && !settings.baseline.recall && info.num_modes > 1;
  }

  // Adjust stage.
  std::vector<std::unique_ptr<PackFilter>> filters;  ///< Empty unless a baseline.
  std::array<bool, kMaxModes> acted{};               ///< Active in the previous pack.
  std::shared_ptr<Drift::Scratch> drift_scratch;
  std::vector<std::unique_ptr<ModeSampler>> samplers;
  std::vector<std::unique_ptr<ModeMemory>> memories;
  std::shared_ptr<SamplerWorkspace> workspace;
  ModeDraws* not_remembered = nullptr;  ///< Draws for which Remember() is pending.
  std::size_t not_remembered_mode = 0;
  /// Widening of the published posterior of each mode, as of the newest usable pack.
  std::array<std::array<double, kMaxParams>, kMaxModes> widening{};
  AdjustResult* states_due = nullptr;  ///< Pack whose final states are not yet computed.
  StateFilter state_filter;
  std::array<double, kMaxParams> state_mean{}, state_sd{};  ///< Of the newest posterior of a plant with states.
  double state_noise = 1.0;                                 ///< Standard deviation of its noise.

  // Execute stage.
  std::unique_ptr<OutputPredictor> predictor;  ///< Null for a described plant.
  OutputTrajectory trajectory;  ///< For a described plant whose prediction differs from the output of its laws.
  std::shared_ptr<SummaryWorkspace> summary;
  ModeData execute_data;
  /// Thinned chain of the last update of each mode: the effective parameters of that pack, which predict it.
  std::array<ThetaTile, kMaxModes> band_theta;
  PredictionTile band_prediction;
  ThetaTile shown_theta;
  std::array<ModeEstimate, kMaxModes> last_estimates;
  std::array<ShownEstimates, 2> shown;        ///< After the previous pack, and after the one before it.
  std::array<bool, kMaxModes> known_draws{};  ///< Some pack has updated the mode.
  int report_mode = 0;
  std::unique_ptr<GapWatch> gap_watch;        ///< Null for an estimator with a lender that has no watch.
  std::unique_ptr<OutputWatch> output_watch;  ///< For a plant with a second equation.

  [[nodiscard]] bool IsOfThisPlant(const DataPack& pack) const noexcept {
    return info.described == nullptr || pack.fingerprint == info.described->plant().fingerprint();
  }
  /// The law predicts the output, so that the prior's mean is a prediction. (For valves it would be zero flow.)
  [[nodiscard]] bool predicts_from_prior() const noexcept {
    return info.described != nullptr ? trajectory.empty() : info.compiled->law_is_output;
  }
  /// The output of a compiled plant is simulated from what its laws explain.
  [[nodiscard]] bool simulates_output() const noexcept {
    return info.compiled != nullptr && !info.compiled->law_is_output;
  }
  void WatchGap(const DataPack& pack, Estimate* e) noexcept;
  /// The published watch: the one with an alarm, or the one closer to it.
  [[nodiscard]] const GapState& Gap() const noexcept;
  /// Output at every sample of the pack with the shown estimates, if effects act on it.
  void PredictShown(const AdjustResult& result, Estimate* e) noexcept;
  /// The same for a described plant, mode by mode.
  void PredictDescribed(const AdjustResult& result, Estimate* e) noexcept;
  /// The same for a described plant whose output is simulated in addition to its laws.
  void PredictSimulated(const DataPack& pack, Estimate* e) noexcept;
  /// Parameters of the simulated output: lane 0 the estimates shown before, the other lanes the current draws.
  void FillSimulated(ThetaTile* theta) const noexcept;
  void PredictOutput(const AdjustResult& result, Estimate* e) noexcept;
  void StoreBandDraws(int mode, const ModeDraws& draws) noexcept;
  /// Output at the last sample and its band; `band_prediction` holds the predictions of `mode`.
  void PredictLastSample(const DataPack& pack, int mode, Estimate* e) noexcept;
  /// Mean and band of outputs, one per lane.
  static void SetBand(const std::array<double, kTileLanes>& outputs, Estimate* e) noexcept;
  static constexpr int kBandDraws = kTileLanes;  ///< Draws behind the predicted output and its band, one tile.
  [[nodiscard]] int BandDraw(const ModeDraws& draws, int lane) const noexcept {
    const int first = draws.burn_in;
    return draws.chain[first + static_cast<int>((static_cast<std::int64_t>(draws.draws - first) * lane) / kBandDraws)];
  }
};

}  // namespace armcmc
