#pragma once

#include <array>
#include <cstdint>

#include "armcmc/forgetting.hpp"
#include "armcmc/laplace.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/noise_model.hpp"
#include "armcmc/parameter_space.hpp"
#include "armcmc/posterior_memory.hpp"

namespace armcmc {

namespace simd {
struct Kernels;
}

/// How the parameters of one mode may have moved since the last pack: what the posterior before a pack becomes before
/// it meets that pack. Three ways, judged by the evidence of the packs:
///
///   persisted        prior = P(u | D^{t-1})                                                  (the paper's
///   reinforcement) drifted          prior = N(m, C + tau^2 n I), tau on a grid, n packs since the last one changed in
///   part  prior = P(u_others | D^{t-1}) P_0(u_j), one parameter j drawn anew
///
/// A drift is believed when its log evidence against "persisted", summed over the packs and kept within +-kDriftNats,
/// reaches kDriftNats, and until it falls below 0. Noise alone climbs from bottom to top with a probability of about
/// exp(-2 kDriftNats). A partial change competes with P_0
/// after a modification, so that one parameter's jump does not lose the others. The pack that holds the jump is a
/// mixture of two plants and teaches nothing: the pack after it may start again from what was known before both.
///
/// Evidences are Laplace approximations: they choose the prior; the posterior under it is then sampled exactly.
class Transition {
 public:
  static constexpr double kDriftNats = 4.0;

  Transition(const simd::Kernels& kernels, int model, const ParameterSpace& space, const NoiseModel& noise,
             const MarginalTable* normal_table);

  /// Chooses the prior of a pack.
  /// @param previous  Posterior before the pack.
  /// @param[in,out] mismatch  Becomes a modification when the pack contradicts what the last modification made.
  /// @param[out] share  Of the returned memory in the prior; the rest is P_0. 0: P_0 alone.
  /// @return `previous`, or a memory of this object, valid until the next call.
  /// @rt No heap, no lock, no throw. At most kMaxParams + 2 Laplace fits.
  const PosteriorMemory& Choose(const ModeData& data, const PosteriorMemory& previous, std::uint64_t pack,
                                Mismatch* mismatch, double* share, LaplaceScratch* scratch) noexcept;

  /// After a pack's posterior: what is trusted from now on.
  void Accept(const PosteriorMemory& next, std::uint64_t pack, Decision decision) noexcept;

 private:
  static constexpr std::array<double, 3> kDrifts{0.004, 0.012, 0.036};  ///< tau, prior standard deviations a pack.

  struct Hypothesis {
    double log_evidence = 0.0;
    ParamVector mean;
    ParamMatrix covariance;
    bool partial = false;
  };

  [[nodiscard]] Hypothesis Judge(const ModeData& data, const ParamVector& mean, const ParamMatrix& covariance,
                                 const ParamVector& start, LaplaceScratch* scratch) const noexcept;
  bool OfferChanges(const ModeData& data, const PosteriorMemory& previous, bool reinforcement,
                    LaplaceScratch* scratch) noexcept;
  [[nodiscard]] double WatchDrift(const ModeData& data, const PosteriorMemory& previous, double packs,
                                  LaplaceScratch* scratch) noexcept;
  void ForgetDrift() noexcept {
    drifts_ = false;
    drift_evidence_.fill(-kDriftNats);
  }
  void SetMemory(const PosteriorMemory& previous, const Hypothesis* hypotheses, int count) noexcept;

  const simd::Kernels& kernels_;
  int model_;
  const ParameterSpace& space_;
  const NoiseModel& noise_;
  const MarginalTable* normal_table_;
  PosteriorMemory memory_;

  bool stable_ = false;  ///< stable_mean_ and stable_covariance_ are the last posterior that a reinforcement confirmed.
  ParamVector stable_mean_;
  ParamMatrix stable_covariance_;
  bool just_modified_ = false;
  std::uint64_t last_pack_ = 0;
  bool drifts_ = false;
  std::array<double, kDrifts.size()> drift_evidence_{-kDriftNats, -kDriftNats,
                                                     -kDriftNats};  ///< Starts at the lower bound.
};

}  // namespace armcmc
