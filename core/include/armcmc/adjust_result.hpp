#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "armcmc/data_pack.hpp"
#include "armcmc/effects/effect_pack.hpp"
#include "armcmc/end_of_pack.hpp"
#include "armcmc/estimate.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

/// The draws of one mode after one pack: what the adjust stage hands to the execute stage.
struct ModeDraws {
  bool known = false;    ///< The data are informative: the posterior is narrower than the prior.
  bool updated = false;  ///< By this pack: the draws below belong to it.
  Decision decision = Decision::kHold;
  int num_samples = 0;  ///< Samples of the pack in this mode.
  double zeta = 0.0, zeta_threshold = 0.0, lambda = 0.0;
  int k_min = 0;
  int draws = 0;           ///< Candidates scored, which is the length of the chain.
  int burn_in = 0;         ///< Iterations discarded: half, or the pilot where that is longer.
  bool truncated = false;  ///< The deadline cut the number of draws.
  double acceptance = 0.0, kish_ess = 0.0, log_evidence = 0.0,
         p_changed = 0.0;  ///< Chain; Kish's effective sample size; nats; probability.
  double p_drifted =
      0.0;  ///< Posterior probability that the parameters drift; 1 - p_changed - p_drifted: they are constant.
  std::array<double, kMaxParams> drift_rate{};  ///< Of each, expected before the pack, prior standard deviations per s.
  /// In a mode about which this pack carries no information: how many times wider each parameter's posterior has
  /// become since it was last updated, at least 1 (Drift::Widening).
  std::array<double, kMaxParams> widening{};
  /// The draws `u` are of the effective parameters of the pack, and `mode_u` is their mode: where these move, those at
  /// its end are AtEnd() (Drift).
  bool moves = false;
  std::array<EndOfPack, kMaxParams> end{};
  /// Some of the draws may be of parameters that have changed, which did not come from where the others did: a draw
  /// that has with probability c moves by c times `end_of_changed`, and 1 - c times `end`.
  bool some_changed = false;
  std::array<EndOfPack, kMaxParams> end_of_changed{};
  int mode_index = 0;                       ///< Candidate with the highest posterior density.
  std::array<double, kMaxParams> mode_u{};  ///< Mode of the target, standardised coordinates.
  bool point_is_mode = false;               ///< mode_u is the point estimate after every decision (least squares).
  int dim = 0;                              ///< Sampled parameters of the mode.
  // Structure of arrays, `draws` entries each.
  std::array<double*, kMaxParams> u{};  ///< Standardised coordinates.
  double* weight = nullptr;             ///< Importance weights, sum 1.
  double* changed = nullptr;            ///< c, where some have changed.
  std::int32_t* visits = nullptr;       ///< Iterations after burn_in that the chain spent at a candidate.
  std::int32_t* chain = nullptr;        ///< Candidate at each iteration of the chain.

  /// Coordinate d of draw k at the end of the pack. @rt O(1).
  [[nodiscard]] double AtEnd(int d, int k) const noexcept ARMCMC_NONBLOCKING {
    const double effective = u[static_cast<std::size_t>(d)][k];
    const double kept = ToEnd(d, effective);
    if (!some_changed) return kept;
    return kept + changed[k] * (end_of_changed[static_cast<std::size_t>(d)](effective) - kept);
  }
  /// The same of any effective coordinate that has not changed.
  [[nodiscard]] double ToEnd(int d, double effective) const noexcept ARMCMC_NONBLOCKING {
    return moves ? end[static_cast<std::size_t>(d)](effective) : effective;
  }
};

/// One result slot. Filled by Estimator::Adjust, read by Estimator::Execute; memory is fixed at construction.
class AdjustResult {
 public:
  /// Room for `capacity` draws of `dim` coordinates in each mode.
  AdjustResult(int num_modes, int dim, int capacity);

  DataPack pack;
  EffectPack effects;  ///< `pack` as a model with effects reads it.
  Status status = Status::kOk;
  int num_modes = 0;
  std::array<ModeDraws, kMaxModes> modes;

 private:
  std::vector<double> doubles_;
  std::vector<std::int32_t> integers_;
};

}  // namespace armcmc
