#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "armcmc/adjust_result.hpp"
#include "armcmc/draw_pace.hpp"
#include "armcmc/drift.hpp"
#include "armcmc/finish_time.hpp"
#include "armcmc/forgetting.hpp"
#include "armcmc/laplace.hpp"
#include "armcmc/marginal_table.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/noise_model.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/parameter_space.hpp"
#include "armcmc/posterior_memory.hpp"
#include "armcmc/power_series.hpp"
#include "armcmc/proposal.hpp"
#include "armcmc/quadratic_score.hpp"
#include "armcmc/ridge.hpp"
#include "armcmc/settings.hpp"
#include "armcmc/transition.hpp"

namespace armcmc {

namespace simd {
struct Kernels;
struct PriorTerms;
}  // namespace simd

inline constexpr int kPilotBlocks = 2;  ///< Parts of the posterior that the pilot's draws are fitted with, at most.

/// Scratch of one adjust step, sized once and shared by the modes, which are adjusted one after the other.
class SamplerWorkspace {
 public:
  /// @param num_linear  Largest LinearPart::num_linear of the modes.
  SamplerWorkspace(int dim, int capacity, int num_linear = 0);

  std::vector<double> log_likelihood, proposal, initial_prior;
  std::array<std::vector<double>, PosteriorMemory::kMaxBlocks> memory;  ///< Density of each block of the memory.
  std::vector<double> weight, group_weight;
  std::vector<double> first_share;     ///< Posterior share of the memory's first block at a candidate.
  std::vector<std::int8_t> component;  ///< Component that a candidate was drawn from.
  std::array<std::vector<double>, kMaxParams + 2> straight;  ///< Scratch of FitBlock.
  [[nodiscard]] std::array<double*, kMaxParams + 2> StraightRows() noexcept ARMCMC_NONBLOCKING;
  LaplaceScratch laplace;
  ThetaPair theta;
  PredictionTile prediction;
  QuadraticScratch quadratic;
  PowerSeries powers;
  std::array<std::vector<double>, kMaxParams> mismatch_u;
  PredictiveMoments predictive;
  std::array<std::array<MarginalTable, kMaxParams>, kPilotBlocks> pilot_tables;
  std::array<ModeData, kMaxModes> data;  ///< Of the pack; read until Remember().
};

/// One ARMCMC step of one mode (algorithm steps 1 to 7).
///
///   target    exp(log_likelihood(u)) prior_t(u),   prior_t = lambda P(u) + (1 - lambda) P_0(u)
///   proposal  q = lambda_q P(u) + (1 - lambda_q) g(u)
///   weight    w = likelihood prior_t / q,   alpha = min(1, w(u*) / w(u))
///
/// P is the posterior after the pack before, P(u | D^{t-1}), as time has left it: at rest or drifting (Drift), so that
/// prior_t has three parts, of parameters that persisted, drifted or changed, with probabilities lambda pi_0,
/// lambda (1 - pi_0) and 1 - lambda. A modification has a prior of its own (Transition).
///
/// g is data driven: first Laplace fits of this pack (against the previous posterior and against P_0) with heavy tails,
/// for a pilot run of kPilotDraws candidates; then mostly a straightened, whitened histogram of the pilot's weighted
/// draws, which then takes over a part of the share of P unless something may have changed. The pilot is part of the
/// half of the chain that is discarded, so adapting q once leaves the chain exact. A share of P_0 keeps q above the
/// target's tails everywhere; where the histogram is bent and P_0 alone is the prior, its tails are covered by the same
/// bends with a wider t law.
class ModeSampler {
 public:
  static constexpr int kPilotDraws = 1024;  ///< In one round.
  static constexpr int kPilotRounds = 3;
  static constexpr int kMaxPilotRounds = 7;  ///< Where there are draws enough.
  static constexpr int kChunkDraws = 512;    ///< Between two readings of the clock, at most.
  static constexpr int kMismatchDraws = 256;
  static constexpr double kLaplaceInflation = 1.2;  ///< Standard deviations of the Laplace components.
  static constexpr double kStudentDof = 5.0;  ///< Tails of the Laplace components, and of the noise scale's memory.

  ModeSampler(const simd::Kernels& kernels, int model, const SamplerSettings& sampler,
              const ForgettingSettings& forgetting, const ParameterSpace& space, const NoiseModel& noise,
              const LinearPart& linear = {}, std::shared_ptr<Drift::Scratch> drift_scratch = Drift::MakeScratch());

  /// Mode of likelihood x initial prior, standardised coordinates, by Gauss-Newton steps.
  /// @rt No heap, no lock, no throw. Some tiles of candidates.
  [[nodiscard]] ParamVector ModeFromPrior(const ModeData& data, SamplerWorkspace* ws) const noexcept ARMCMC_NONBLOCKING;

  /// Draws from the posterior after a pack. Remember() has to follow before the next call, unless kNonFinite is
  /// returned.
  /// @param previous   Posterior before this pack; !valid before the first. Stays as it is until Remember().
  /// @param data       At least forgetting.min_samples samples.
  /// @param limit      Upper bound on the draws, to repeat a truncated run.
  /// @return kOk, kTruncated or kNonFinite.
  /// @rt No heap, no lock, no throw. O(max_draws samples).
  Status Run(const ModeData& data, const PosteriorMemory& previous, std::uint64_t pack, std::uint64_t mode,
             Nanos deadline_ns, ClockRef clock, int limit, SamplerWorkspace* workspace,
             ModeDraws* out) noexcept ARMCMC_NONBLOCKING;

  /// What the next pack starts from: the draws of the newest Run(), as densities.
  ///
  /// Nothing in `out` depends on it but out->known, and that only until something is known: before that it has to be
  /// called before `out` is handed on.
  /// @param workspace, out  Of that Run(), as it left them.
  /// @rt No heap, no lock, no throw. O(max_draws).
  void Remember(ClockRef clock, SamplerWorkspace* workspace, PosteriorMemory* next,
                ModeDraws* out) noexcept ARMCMC_NONBLOCKING;

  [[nodiscard]] const ParameterSpace& space() const noexcept { return space_; }
  [[nodiscard]] const NoiseModel& noise() const noexcept { return noise_; }
  /// Table of the blocks that have none of their own.
  [[nodiscard]] const MarginalTable& shared_table() const noexcept { return normal_table_; }
  /// What is trusted across a change: part of what a snapshot holds.
  [[nodiscard]] Transition& transition() noexcept { return transition_; }
  [[nodiscard]] Drift& drift() noexcept { return drift_; }

  /// Means and covariances of the parameters before a pack: as the last pack left them, and as they have drifted since.
  struct Drifted {
    bool any = false;   ///< They have; else the rest is not set.
    double at_s = 0.0;  ///< Plant time of the pack.
    ParamVector last_mean, mean;
    ParamMatrix last_covariance, covariance;
  };
  /// Of the newest Run(). What the noise scale has become is not in it.
  [[nodiscard]] const Drifted& drifted() const noexcept { return drifted_; }

 private:
  /// Draws after a pilot that there was no time to finish. made + DrawsWithoutFullPilot(made) rises with every round of
  /// more than two tiles, and so tells how many rounds there were.
  static constexpr int DrawsWithoutFullPilot(int made, int wanted) noexcept {
    return std::min(kChunkDraws, (wanted - made) / 8 / kTileLanes * kTileLanes);
  }
  /// Between two readings of the clock: a quarter of the draws, whole tiles.
  static constexpr int ChunkDraws(int wanted) noexcept {
    return std::clamp(wanted / 4 / kTileLanes * kTileLanes, kTileLanes, kChunkDraws);
  }

  /// What Run() leaves to Remember().
  struct Unfinished {
    const ModeData* data = nullptr;
    const PosteriorMemory* previous = nullptr;
    double lambda = 0.0;         ///< Its share in the prior.
    int first = 0;               ///< Draw that counts, after the pilot.
    double mass_first = 0.0;     ///< Of the first block of `previous`.
    double mass_new = 0.0;       ///< Of what was drawn anew: changed at this pack.
    double mass_changed = 0.0;   ///< Changed at this pack or, where `previous` has a third block, at the one before.
    bool first_changed = false;  ///< mass_first and first_share are of what changed.
    bool apart = false;          ///< What changed is probable enough for a posterior of its own.
    /// What was carried on through time is rest and drift in two blocks: the more probable is handed on, and the other
    /// unless it is improbable.
    bool split = false;
    bool calibrated = false;  ///< The weights, by control variates.
    Drift::Part part = Drift::Part::kRest;
  };

  /// Until when a pack may draw, and how much at most.
  struct DrawTime {
    Nanos deadline_ns;
    ClockRef clock;
    int limit;
    Nanos anchor_ns;  ///< What an anchor of a ridge may take.
    bool informed;    ///< The result need not wait for Remember().
  };
  /// A fit from far away takes many steps and says little on anchors that begin next to each other: twice what the
  /// ridges before this one took, where there were any.
  /// @param anchor_ns  What the fit of this pack promises for an anchor.
  [[nodiscard]] Nanos TimeOfRidge(int anchors, Nanos anchor_ns) const noexcept ARMCMC_NONBLOCKING {
    const Nanos known_ns = ridge_time_.Predict(anchors);
    return known_ns > 0 ? std::min(anchors * anchor_ns, 2 * known_ns) : anchors * anchor_ns;
  }
  /// From the last of so many draws until the result can be handed over, at the usual pace.
  [[nodiscard]] Nanos TimeAfter(int draws, bool informed) const noexcept ARMCMC_NONBLOCKING {
    return finish_time_.Predict(draws) + (informed ? 0 : remember_time_.Predict(draws));
  }

  /// How the data fit what `previous` predicts. Where they do not, and rest and drift have a block each, how they fit
  /// the one that predicts them best: mean and variance of two predictions that are apart are those of neither.
  /// @rt No heap, no lock, no throw. kMismatchDraws predictions, and as many for each block where it asks them.
  Mismatch Compare(const ModeData& data, const PosteriorMemory& previous, RandomStream stream,
                   SamplerWorkspace* ws) const noexcept ARMCMC_NONBLOCKING;
  /// @param first, last  Blocks of `previous`, without the last.
  Mismatch CompareBlocks(const ModeData& data, const PosteriorMemory& previous, int first, int last,
                         const RandomStream& stream, SamplerWorkspace* ws) const noexcept ARMCMC_NONBLOCKING;
  void FitLaplace(const ModeData& data, const PosteriorMemory& previous, bool use_previous, const RandomStream& stream,
                  SamplerWorkspace* ws) noexcept ARMCMC_NONBLOCKING;
  /// Laplace fit under a memory with these moments.
  void FitUnder(const ParamVector& mean, const ParamMatrix& covariance, const ModeData& data, SamplerWorkspace* ws,
                Gaussian* fit) noexcept ARMCMC_NONBLOCKING;
  /// The Laplace fits of the constant and the drifting hypothesis, which may have separated.
  void FitConstantAndDrifting(const ModeData& data, const PosteriorMemory& previous,
                              SamplerWorkspace* ws) noexcept ARMCMC_NONBLOCKING;
  /// Laplace fits under P_0 from the best of some draws of it: a law that is not linear may have several modes, and the
  /// mean of P_0 may lie beside none of them. Leaves the best by its mass in `fit`, which has the log posterior `best`.
  void FitFromScattered(const ModeData& data, const RandomStream& stream, SamplerWorkspace* ws, double best,
                        Gaussian* fit) const noexcept ARMCMC_NONBLOCKING;
  void BuildProposal(const PosteriorMemory& previous, double lambda_q, bool use_previous, int num_pilot_blocks,
                     Proposal* proposal) noexcept ARMCMC_NONBLOCKING;
  /// The Laplace fits under what is carried on.
  void AddPersisted(double share, Proposal* proposal) const noexcept ARMCMC_NONBLOCKING;
  void DrawAndScore(const Proposal& proposal, const PosteriorMemory& previous, const ModeData& data, int first,
                    int count, const RandomStream& stream, SamplerWorkspace* ws,
                    ModeDraws* out) const noexcept ARMCMC_NONBLOCKING;
  /// Weights of [first, last) from the scored quantities. @return log of the factor taken out, or NaN if none is
  /// finite.
  double Weigh(const PosteriorMemory& previous, double lambda, int first, int last,
               SamplerWorkspace* ws) const noexcept ARMCMC_NONBLOCKING;
  /// prior_t at the candidates from `first` on.
  [[nodiscard]] simd::PriorTerms Prior(const PosteriorMemory& previous, double lambda, int first,
                                       const SamplerWorkspace& ws) const noexcept ARMCMC_NONBLOCKING;
  /// What of the prior a draw came from: P_0 or a third block of the memory, which is of a change, or the other blocks.
  enum class Origin : std::uint8_t { kAny, kChanged, kPersisted, kFirst, kSecond };
  /// Weights of [first, last) times the probability of that origin, at the places of the draws.
  const double* GroupWeights(Origin origin, const PosteriorMemory& previous, double lambda, int first, int last,
                             SamplerWorkspace* ws) const noexcept ARMCMC_NONBLOCKING;
  /// Fits the pilot's weighted draws [first, last). @return number of blocks; *ess their effective number.
  int FitPilot(const PosteriorMemory& previous, double lambda, int first, int last, SamplerWorkspace* ws,
               const ModeDraws& draws, double* ess) noexcept ARMCMC_NONBLOCKING;
  /// Draws in rounds until the posterior is known well enough to draw the rest from: Laplace fits; where they are a
  /// poor match, the ridge; where that fails, too, powers of the posterior that come nearer to it round by round.
  ///
  /// A round that would not leave time for a chunk of draws is not begun: then `in_haste`, and DrawsWithoutFullPilot()
  /// follow. A run that is limited to as many draws as that makes the same rounds.
  /// @param[out] proposal  For the rest. @return the number of draws made, at most half of `wanted` after the first
  /// kPilotRounds.
  int RunPilot(const ModeData& data, const PosteriorMemory& previous, bool use_previous, double lambda, double lambda_q,
               int wanted, const DrawTime& time, const RandomStream& stream, SamplerWorkspace* ws, Proposal* proposal,
               ModeDraws* out, bool* in_haste) noexcept ARMCMC_NONBLOCKING;
  /// Proposal along the ridge of this pack, with about so many anchors. @return false when there is none.
  bool BuildRidgeProposal(const ModeData& data, const PosteriorMemory& previous, bool use_previous, double lambda_q,
                          int anchors, SamplerWorkspace* ws, Proposal* proposal) noexcept ARMCMC_NONBLOCKING;
  /// Mode of the target: the best draw, climbed to the top after a modification (when AR-MAP reports it) whose prior
  /// is P_0 alone.
  void FindMode(const ModeData& data, bool climb, SamplerWorkspace* ws,
                ModeDraws* out) const noexcept ARMCMC_NONBLOCKING;
  /// Control variates on the weights [first, last) of the result; the chain keeps its own. @return whether they apply.
  bool ReduceSamplingError(int first, int last, bool use_previous, SamplerWorkspace* ws,
                           ModeDraws* out) const noexcept ARMCMC_NONBLOCKING;
  /// The chain over the draws from `first` on, the first after the pilot.
  void RunChain(const RandomStream& stream, int first, SamplerWorkspace* ws,
                ModeDraws* out) const noexcept ARMCMC_NONBLOCKING;
  /// Where the draws' prior came from: fills first_share and the masses of what is unfinished.
  void SplitMassByPrior(SamplerWorkspace* ws, ModeDraws* out) noexcept ARMCMC_NONBLOCKING;
  /// The draws of what is unfinished.
  [[nodiscard]] Drift::Draws DrawsForDrift(SamplerWorkspace* ws,
                                           const ModeDraws& draws) const noexcept ARMCMC_NONBLOCKING;
  /// Where the draws are of effective parameters: what those at the end of the pack are (ModeDraws::moves).
  void FindEndOfPack(const ModeData& data, SamplerWorkspace* ws, ModeDraws* out) noexcept ARMCMC_NONBLOCKING;
  void Compress(SamplerWorkspace* ws, PosteriorMemory* next, ModeDraws* out) noexcept ARMCMC_NONBLOCKING;
  /// Gives a block of the parameters the noise scale of the draws [first, first + count): a t law with a standard
  /// deviation of log s of at least kNoiseMemory, so that a level six standard deviations away is not considered
  /// impossible.
  void AppendNoiseScale(int first, int count, const double* weight, MarginalTable* table, const ModeDraws& draws,
                        DensityBlock* block) const noexcept ARMCMC_NONBLOCKING;
  /// A faster score for most candidates of this pack, if there is one.
  void PrepareScore(const ModeData& data, bool use_previous, SamplerWorkspace* ws) noexcept ARMCMC_NONBLOCKING;
  /// Log-likelihood of the candidates [first, end), by powers from ws->powers. False, and nothing is scored, if too
  /// many are out of their reach.
  bool ScoreNear(const ModeData& data, int first, int end, double* const* u,
                 SamplerWorkspace* ws) const noexcept ARMCMC_NONBLOCKING;
  void ScoreAll(const ModeData& data, int first, int end, double* const* u,
                SamplerWorkspace* ws) const noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] int DrawTarget(const Mismatch& mismatch, ModeDraws* out) const noexcept ARMCMC_NONBLOCKING;

  ModeSampler(const ModeSampler&) = delete;  // transition_ refers to other members
  ModeSampler& operator=(const ModeSampler&) = delete;

  const simd::Kernels& kernels_;
  int model_;
  SamplerSettings sampler_;
  ForgettingSettings forgetting_;
  ParameterSpace space_;
  NoiseModel noise_;
  QuadraticScore quadratic_;
  const MarginalTable &normal_table_, &student_table_;
  Transition transition_;
  Drift drift_;
  std::array<MarginalTable, kMaxParams> uniform_tables_;
  DensityBlock initial_block_;  ///< P_0 as a proposal component.
  DensityBlock laplace_fresh_;
  std::array<DensityBlock, PosteriorMemory::kMaxBlocks> laplace_persisted_;  ///< One for each change in part, else one.
  int num_persisted_ = 0;
  std::array<DensityBlock, kPilotBlocks> pilot_blocks_;
  std::array<DensityBlock, kPilotBlocks> tail_blocks_;  ///< With heavier tails, where they are bent.
  int laplace_fits_ = 1;                                ///< That FitLaplace made.
  bool pilot_lacks_ = false;  ///< A part of the pilot's draws was too small for a block of its own.
  Gaussian fit_fresh_, fit_persisted_;
  std::array<RidgeAnchor, kRidgeAnchors> anchors_;
  std::array<DensityBlock, kRidgeAnchors> ridge_blocks_;
  bool may_have_changed_ = false;  ///< P_0 has a share in the prior that counts.
  double memory_inside_ = 1.0;     ///< Share of the memory's mass inside the bounds.
  Unfinished unfinished_;
  Drifted drifted_;
  // They steer the deadline only.
  FinishTime finish_time_;    ///< From the last draw to the end of Run().
  FinishTime ridge_time_;     ///< Of the anchors of a ridge.
  FinishTime remember_time_;  ///< Of Remember().
  DrawPace draw_pace_;
};

}  // namespace armcmc
