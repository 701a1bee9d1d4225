#pragma once

#include <array>

#include "armcmc/forgetting.hpp"
#include "armcmc/laplace.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/noise_model.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/parameter_space.hpp"
#include "armcmc/posterior_memory.hpp"

namespace armcmc {

class SnapshotReader;
class SnapshotWriter;
namespace simd {
struct Kernels;
}

/// Prior of a pack: how the parameters of one mode may have changed since the previous pack. P is the posterior
/// P(u | D^{t-1}) of the previous pack, propagated by Drift to the time of this pack: constant parameters with
/// probability pi_0, drifting ones with 1 - pi_0.
///
///   persisted, drifted  prior = lambda P(u) + (1 - lambda) P_0   the paper's reinforcement
///   changed in part     prior = P(u_others) P_0(u_j)             one coordinate j drawn anew: a parameter or the noise
///   changed             prior = P_0                              the paper's modification
///
/// After a modification partial changes compete with P_0, so that a jump of one parameter does not discard the others.
/// The pack that contains the jump is a mixture of two plants and carries no usable information: the pack after it may
/// start again from the posterior before both.
///
/// Without partial changes (ForgettingSettings::partial_change) a modification is the paper's: P_0 alone. Without drift
/// (ForgettingSettings::drift_share = 0) P is P(u | D^{t-1}), and the rule as a whole is the paper's.
///
/// Evidences are Laplace approximations: they choose the prior; the posterior under it is then sampled exactly.
class Transition {
 public:
  Transition(const simd::Kernels& kernels, int model, const ParameterSpace& space, const NoiseModel& noise,
             const MarginalTable* normal_table, bool partial_change);

  /// Time has passed over the posterior before a pack: what is trusted across a change moves on as much.
  /// @rt No heap, no lock, no throw. O(dim).
  void Age(const PosteriorMemory& before, const PosteriorMemory& now) noexcept ARMCMC_NONBLOCKING;

  /// Chooses the prior of a pack.
  /// @param previous  Posterior before the pack, as Drift::Carry() returns it.
  /// @param[in,out] mismatch  Becomes a modification when the pack contradicts what the last modification made.
  /// @param[out] share  Of the returned memory in the prior; the rest is P_0. 0: P_0 alone.
  /// @return `previous`, or a memory of this object, valid until the next call.
  /// @rt No heap, no lock, no throw. At most kMaxParams + 2 Laplace fits.
  const PosteriorMemory& Choose(const ModeData& data, const PosteriorMemory& previous, Mismatch* mismatch,
                                double* share, LaplaceScratch* scratch) noexcept ARMCMC_NONBLOCKING;

  /// Whether `memory` stands for changes in part.
  [[nodiscard]] bool Offers(const PosteriorMemory& memory) const noexcept { return &memory == &memory_; }
  /// Laplace fit of the pack under block b of that memory.
  [[nodiscard]] const Gaussian& fit(int b) const noexcept { return fits_[static_cast<std::size_t>(b)]; }

  /// After a pack's posterior: what is trusted from now on.
  void Accept(const PosteriorMemory& next, Decision decision) noexcept ARMCMC_NONBLOCKING;

  /// What is trusted, for Restore(), which is bit-identical.
  void Save(SnapshotWriter* out) const noexcept ARMCMC_NONBLOCKING;
  void Restore(SnapshotReader* in) noexcept ARMCMC_NONBLOCKING;

 private:
  struct Hypothesis {
    double log_evidence = 0.0;
    ParamVector mean;
    ParamMatrix covariance;
    Gaussian fit;
  };

  [[nodiscard]] Hypothesis Judge(const ModeData& data, const ParamVector& mean, const ParamMatrix& covariance,
                                 const ParamVector& start, LaplaceScratch* scratch) const noexcept ARMCMC_NONBLOCKING;
  bool OfferChanges(const ModeData& data, const PosteriorMemory& previous, bool reinforcement,
                    LaplaceScratch* scratch) noexcept ARMCMC_NONBLOCKING;
  void SetMemory(const PosteriorMemory& previous, const Hypothesis* hypotheses, int count) noexcept ARMCMC_NONBLOCKING;

  const simd::Kernels& kernels_;
  int model_;
  const ParameterSpace& space_;
  const NoiseModel& noise_;
  const MarginalTable* normal_table_;
  bool partial_change_;
  PosteriorMemory memory_;
  std::array<Gaussian, PosteriorMemory::kMaxBlocks> fits_;

  bool stable_ = false;  ///< stable_mean_ and stable_covariance_ are the last posterior that a reinforcement confirmed.
  ParamVector stable_mean_;
  ParamMatrix stable_covariance_;
  ParamVector moved_, widened_;  ///< By time, since the pack before: of the mean, and of the variances.
  bool just_modified_ = false;
  bool restarted_ = false;  ///< This pack starts again from what was known before the last one.
};

}  // namespace armcmc
