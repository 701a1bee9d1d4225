#pragma once

#include <array>
#include <cstdint>

#include "armcmc/gap_watch/gap_state.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

class SnapshotReader;
class SnapshotWriter;

/// What a pack did to the posterior (algorithm step 2).
enum class Decision : std::uint8_t { kHold = 0, kReinforcement = 1, kModification = 2 };

/// One marginal of the posterior, in the unit of the quantity.
struct MarginalSummary {
  double ar_map = 0.0;  ///< Mode of the draws after a modification, mean after a reinforcement.
  /// Posterior mean: of the draws, each with its importance weight, sampling error reduced by control variates.
  double ar_ap = 0.0;
  double sd = 0.0;
  double q025 = 0.0, q25 = 0.0, q50 = 0.0, q75 = 0.0, q975 = 0.0;
  double chain_mean = 0.0;  ///< Mean of the chain, in which a draw counts as often as it was visited.
  double is_sd = 0.0;       ///< Standard deviation by the weights; `sd` and the quantiles are the chain's.
  double histogram_lo = 0.0, histogram_hi = 0.0;
  std::array<double, kHistogramBins> density{};  ///< Integrates to 1 over [lo, hi].
};

/// The estimate of one mode. zeta: in noise scales; log_evidence: nats; noise_std: unit of the regression target.
struct ModeEstimate {
  bool known = false;    ///< The data are informative: the posterior has become narrower than the prior.
  bool updated = false;  ///< By this pack.
  Decision decision = Decision::kHold;
  int num_samples = 0;  ///< Samples of the pack that belong to this mode.
  double zeta = 0.0, zeta_threshold = 0.0, lambda = 0.0;
  int k_min = 0, draws = 0;
  bool truncated = false;
  double ess = 0.0;       ///< Effective sample size of the chain (autocorrelation).
  double kish_ess = 0.0;  ///< Effective sample size of the importance weights.
  double acceptance = 0.0, log_evidence = 0.0, p_changed = 0.0, noise_std = 0.0;
  double p_drifted =
      0.0;  ///< Probability that the parameters drift; 1 - p_changed - p_drifted: that they are constant.
  /// Expected speed of a reported quantity, in its unit per second, before the pack.
  std::array<double, kMaxReported> drift_rate{};
  std::array<MarginalSummary, kMaxReported> marginal{};  ///< Order of PlantModel::reported().

  /// What a pack without information about the mode leaves unchanged: the parameters and the noise.
  void Save(int num_reported, SnapshotWriter* out) const noexcept ARMCMC_NONBLOCKING;
  void Restore(int num_reported, SnapshotReader* in) noexcept ARMCMC_NONBLOCKING;
  /// The same of drift.
  void SaveDrift(int num_reported, SnapshotWriter* out) const noexcept ARMCMC_NONBLOCKING;
  void RestoreDrift(int num_reported, SnapshotReader* in) noexcept ARMCMC_NONBLOCKING;
};

/// Everything that the execute stage reports about one pack. Plain data of fixed size.
struct Estimate {
  std::int64_t seq = 0, run_id = 0;
  Nanos t_last_ns = 0;
  double t_last_s = 0.0;
  int num_reported = 0, num_modes = 0;
  int mode = 0;         ///< Mode at the last sample, or num_modes when no identified mode acts (free motion).
  int report_mode = 0;  ///< Mode whose parameters are reported: `mode`, else the last one known.
  bool active = false;  ///< `mode` is an identified mode.
  std::array<ModeEstimate, kMaxModes> modes{};
  double y_pred = 0.0, y_lo = 0.0, y_hi = 0.0;  ///< Output predicted for the last sample and its 95 % band.
  double y_rmse = 0.0;                          ///< Rms error over the pack, predicted from the posterior after it.
  double y_free_run = 0.0;  ///< Output at the last sample predicted from the inputs alone since the start (actuator).
  int num_samples = 0;
  /// Output at every sample of the pack as a user would have seen it predicted: with the point estimates that were on
  /// display then, those of the pack before the previous one (the paper's timeline). A contact force is predicted from
  /// the start, with the posterior's (before the first pack the prior's) mean until the parameters are known; an angle
  /// is NaN until then.
  std::array<double, kMaxPackSamples> y_shown{};
  std::array<double, kMaxPackSamples> y_shown_free_run{};  ///< The same from the inputs alone since the start.
  GapState gap;                                            ///< Whether the model is missing something.
};

/// What was expected of a pack before it was seen: what the law explains, from the posterior after the pack before.
struct PackForecast {
  int num_samples = 0;
  std::array<double, kMaxPackSamples> target{};  ///< Measured. NaN: no mode acts that has been learnt.
  std::array<double, kMaxPackSamples> centre{};  ///< Expected, same unit.
  /// Standard deviation of the expected value: parameters, and where a plant's states begin. Without noise.
  std::array<double, kMaxPackSamples> sd{};
  std::array<double, kMaxPackSamples> noise_std{};  ///< Scale of the noise's law.
};

}  // namespace armcmc
