#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "armcmc/drift_filter.hpp"
#include "armcmc/end_of_pack.hpp"
#include "armcmc/laplace.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/noise_model.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/normal_mixture.hpp"
#include "armcmc/parameter_space.hpp"
#include "armcmc/posterior_memory.hpp"

namespace armcmc {

class SnapshotReader;
class SnapshotWriter;
namespace simd {
struct Kernels;
struct QuadraticControl;
}  // namespace simd

/// Drift of the parameters of one mode, learnt from the packs.
///
/// Under hypothesis h the standardised parameters u move at a velocity w with correlation time tau_h:
///
///   du/dt = w,   dw = -w / tau_h dt + s_h sqrt(2 / tau_h) dW,   w ~ N(0, s_h^2) in the long run
///
/// s_h is the rate, in prior standard deviations per second. h = 0 is "rest", s = 0. Under kTogether every parameter
/// moves at the rate of the hypothesis; correlation times are short, for velocities that change, or long, for steady
/// trends, whose intervals would otherwise be too wide. The rates of trends are a factor of two apart: at three, the
/// intervals for a rate in between do not fit. Under the others, one for each parameter of several, this parameter
/// alone moves (kAlone): otherwise a drift of one would widen the intervals of all. All are equally probable.
///
/// The posterior of h and the split of u among them are a bank of Gaussian filters in (u, w), in closed form:
///
///   time     pi_h <- e^{-kappa dt} pi_h + (1 - e^{-kappa dt}) pi_h^0, new members from rest and from drift with a
///            velocity of their own; then u <- u + b w, w <- phi w + noise (phi = e^{-dt / tau}, b = tau (1 - phi)).
///            A time in which several changes are expected (kappa dt > 1) passes in up to kMostSteps steps, between
///            which one drift becomes another; what has drifted in it counts as drift
///   gap      what drifts may end, or become another drift, while there are no packs. The time until then is uniform in
///            the gap g, of which at most the mean life 1 / kappa counts: mean m + g/2 w and covariance
///            C_u + g/2 (C_uw + C_wu) + g^2/3 C_w + g^2/12 w w', within the bounds below. With the end at the
///            last pack instead, a plant that stopped in the air would be where neither rest nor drift expects it
///   merging  it takes several packs to tell a new member from the old ones, and if merged at once, members that the
///            data refute would widen those that the data support. So each hypothesis has kSlots filters in the order
///            in which they began. The two neighbours whose merging by moments loses least become one: by Runnalls'
///            bound of the Kullback-Leibler divergence, (p + q) log|C| - p log|C_p| - q log|C_q| over 2 (Kullback-
///            Leibler approach to Gaussian mixture reduction, IEEE Trans. Aerosp. Electron. Syst. 43, 2007)
///   bounds   if the variance of a parameter would exceed that of P_0 by a factor c > 1, variance and mean are divided
///            by c: after a long time without information a drifting parameter returns to P_0
///   motion   u is that at the end of the pack, and u - w s that s seconds before. For the sampler, the parameters of a
///            pack are constant: it draws the effective ones, v = u - T w, of which the law with constant parameters
///            gives, to first order, the likelihood of a pack in which they move (below)
///   pack     log L(v) = a' (v - m) - (v - m)' H (v - m) / 2 about the posterior mean m, H the Fisher information;
///            pi_h times the evidence of that, with every filter updated by the same a, H, m
///   sampled  the sampled part (rest, drift, or the whole bank) is corrected by the affine map from the posterior
///            according to this expansion to the sampled posterior. Both are taken from the same draws, whose weights
///            exp(expansion - log L) turn from the one into the other: chance cancels, and for a linear law the map is
///            the identity, so that nothing of the sampling error is handed on. What the draws under the expansion
///            differ from the filters by more than chance is real, too: the prior that was sampled is no Gaussian. Not
///            so for a linear law far from all bounds, where the filters are exact and the density sampled is not. The
///            probability of drift is corrected by the odds of the same draws. A part that was not sampled keeps the
///            result of its own filters: the draws of a part that the data refute carry no information about it
///
/// Effective parameters. With the lagged sums of LocalLikelihood the log-likelihood in (v, w) is
///
///   a' (v - m) - (v - m)' H (v - m) / 2                                             the law with constant parameters
///   + (T' a - b)' w - (v - m)' (H T - H_1) w - w' (T' H T - T' H_1 - H_1 T + H_2) w / 2
///
/// T = H^-1 H_1 makes the product of v and w vanish: the sums of the second line are what the pack tells of w whatever
/// v is, and Carry() gives them to the filters. H_1 / H is the mean time from a sample to the end of the pack, and in
/// directions that the pack hardly determines T w is many times that: what a constant law would find there is far from
/// the parameters at any time of the pack. Without it the intervals of drifting parameters miss the truth. Where H is
/// little beside P_0, v would be beyond all bounds: a little of both priors' precision is added to H. Posteriors that
/// are stored, and the draws, are effective; the bank and what is published are at the end. What rests has v = u.
///
/// Published are the draws, moved (EndOfPack) from their distribution under the expansion to that of the bank at the
/// end of the pack: by its quantiles, and beyond the outermost so that the variance is the bank's. For a linear law
/// they are the bank itself. The bank knows more than the prior that was sampled, in which rest and the drifts of
/// several parameters are a Gaussian each: where one drifts alone, the others are narrow with wide tails.
///
/// While the memory is two posteriors, without and with a change, the bank is that of the more probable one. It starts
/// again, with the rates that it knows, whenever the other one becomes that. The other one is carried on as a third
/// part, which time moves and widens as it does the bank; its draws move to the end of the pack by the velocities that
/// were expected before it. A change too improbable for a posterior of its own is in the bank (AddChanged): a
/// ten-thousandth that is far away may be a third of the variance, and soon most of what rests. Not while drift is
/// improbable: what is sampled then is what is published, and a Gaussian with that variance would be too wide for it.
///
/// A sampled posterior is stored as two densities, rest and drift, with each draw weighted by the probability that it
/// came from that part; if one of them is improbable or has too few draws, a single density P is stored. Before the
/// next pack this becomes
///
///   pi_0 P_rest(u) + (1 - pi_0) P_drift(u)
///
/// Each term is derived from its own density, or from P if there is only one. P_rest is P under the affine map to the
/// mean and covariance that the bank has for rest; like P it can be drawn from and evaluated. P_drift is the mixture of
/// the hypotheses for one parameter, and for several the Gaussian with the same moments: if the shape of P, narrower
/// than a Gaussian in its core, were passed on from pack to pack, each posterior would narrow the bank a little more.
/// (With a sampled noise scale P_drift is an affine map of P, too.) While drift is improbable (kNegligible), P_rest is
/// the prior.
///
/// The noise scale is not a coordinate of the bank: its memory is wide enough (ModeSampler::AppendNoiseScale).
class Drift {
 public:
  struct Law {
    double rate;         ///< s, prior standard deviations per s.
    double persistence;  ///< tau, s.
  };
  static constexpr std::array<Law, 8> kTogether{
      {{.1, 30.}, {.3, 30.}, {.003, 200.}, {.006, 200.}, {.012, 200.}, {.025, 200.}, {.05, 200.}, {.1, 200.}}};
  static constexpr Law kAlone{0.03, 200.0};
  static constexpr double kSwitching = 0.03;   ///< kappa, 1/s: a drift begins, ends, or becomes another.
  static constexpr double kNegligible = 0.01;  ///< Probability below which a part is left out of the prior of a pack.
  static constexpr int kFirstAlone = 1 + static_cast<int>(kTogether.size());
  static constexpr int kHypotheses = kFirstAlone + kMaxParams;  ///< At most.
  static constexpr int kSlots = 11;                             ///< Filters of a hypothesis.
  static constexpr int kFilters = kSlots * kHypotheses;
  static constexpr int kMostSteps = 8;  ///< Of a time without data.

  /// Of what the bank holds.
  enum class Part : std::uint8_t { kWhole, kRest, kDrift };

  /// Under which a plant with some number of parameters can be.
  [[nodiscard]] static constexpr int NumHypotheses(int dim) noexcept { return kFirstAlone + (dim > 1 ? dim : 0); }

  struct Hypothesis {
    double rate = 0.0, persistence = 1.0, prior = 0.0;
    int alone = -1;  ///< The parameter that moves; -1: all of them.
    [[nodiscard]] bool Moves(Eigen::Index d) const noexcept { return alone < 0 || alone == d; }
    /// Whose velocities a filter of this hypothesis has: none at rest.
    [[nodiscard]] MovingParameters Moving(int dim) const noexcept ARMCMC_NONBLOCKING;
    /// The exact solution of the equation above over a time.
    [[nodiscard]] DriftStep Step(double elapsed_s) const noexcept ARMCMC_NONBLOCKING;
  };
  /// Hypothesis h < NumHypotheses(dim) where drift has the probability `share`.
  [[nodiscard]] static Hypothesis Of(int h, double share, int dim) noexcept ARMCMC_NONBLOCKING;

  /// What lies between Carry() and Learn() of one pack: several objects may take turns with it.
  class Scratch;
  [[nodiscard]] static std::shared_ptr<Scratch> MakeScratch();

  /// @param share  Prior probability that the plant drifts, in [0, 1). 0: it rests, and Carry() changes nothing.
  Drift(const simd::Kernels& kernels, int model, const ParameterSpace& space, const NoiseModel& noise, double share,
        std::shared_ptr<Scratch> scratch);

  /// How many times wider the posterior after the last pack has become by a time at which nothing new is known: the
  /// root mean square distance of each parameter in the bank from the mean that it had then, over its standard
  /// deviation then. 1 where it is narrower, and for all of them while drift is improbable (kNegligible).
  /// @param time_s  Plant time, s.
  /// @rt No heap, no lock, no throw. O(hypotheses dim^2).
  void Widening(double time_s, const PosteriorMemory& last,
                std::array<double, kMaxParams>* ratio) noexcept ARMCMC_NONBLOCKING;

  /// What the posterior after the last pack has become by the time of this one.
  /// @return `last`, or a memory of this object, valid until the next call; of the effective parameters.
  /// @rt No heap, no lock, no throw. O(hypotheses dim^3), and a Laplace fit.
  const PosteriorMemory& Carry(const ModeData& data, const PosteriorMemory& last,
                               LaplaceScratch* scratch) noexcept ARMCMC_NONBLOCKING;
  /// Whether `memory` is one posterior at rest and drifting, and not two posteriors.
  [[nodiscard]] bool Splits(const PosteriorMemory& memory) const noexcept { return &memory == &carried_ && split_; }
  /// Of what is not split.
  [[nodiscard]] Part CarriedPart() const noexcept ARMCMC_NONBLOCKING;
  /// Mean and covariance at the end of the pack of the last Carry(), as expected before it; null: as after the pack
  /// before. Unlike what is carried on, they owe nothing to the pack.
  struct Expected {
    ParamVector mean;
    ParamMatrix covariance;
  };
  [[nodiscard]] const Expected* expected() const noexcept { return moves_ ? &expected_ : nullptr; }
  /// Which block of a memory that is split drifts.
  [[nodiscard]] int drifting_block() const noexcept { return drifting_block_; }

  /// Draws of a pack, of effective parameters: they tell how the posterior differs from that under the expansion.
  struct Draws {
    int count = 0;  ///< Rows are padded to whole vectors, with a weight of 0.
    std::array<const double*, kMaxParams> u{};
    const double* weight = nullptr;
    const double* log_likelihood = nullptr;
    const double* share = nullptr;  ///< Posterior probability that a draw is of `part`; null: not known.
    Part part = Part::kWhole;
    bool of_part = true;  ///< false: `share` is the probability that it is of what has changed.
    /// What has changed is a posterior of its own, and in no filter.
    bool apart = false;
    double* scratch = nullptr;  ///< As long as the rows.

    /// Probability that draw k is of what the bank has. @pre `share` is known. @rt O(1).
    [[nodiscard]] double InBank(int k) const noexcept ARMCMC_NONBLOCKING {
      if (!apart) return 1.0;
      return of_part ? share[k] : 1.0 - share[k];
    }
    /// Into the scratch: the weights, each times that probability. @pre `share` is known. @rt O(count).
    void WeighInBank() const noexcept ARMCMC_NONBLOCKING;
  };

  /// After Carry(): from the effective parameters of the pack to those at its end.
  /// @param mean       Of the effective parameters.
  /// @param p_drifted  Probability that parameters that have not changed drift, as sampled. Becomes that of the bank,
  /// which has the hypotheses one by one, corrected by what the draws tell of the expansion.
  /// @param[out] end   Of each parameter.
  /// @return false where nothing moves, and the rest is not set.
  /// @rt No heap, no lock, no throw. O(hypotheses dim^3 + draws dim^2).
  bool FindEnd(const ModeData& data, const ParamVector& mean, double log_noise_scale, const Draws& draws,
               double* p_drifted, LaplaceScratch* scratch,
               std::array<EndOfPack, kMaxParams>* end) noexcept ARMCMC_NONBLOCKING;

  /// After Carry(): what has changed at the pack with some probability and is no posterior of its own joins the bank,
  /// as newcomers from P_0 with the velocities that were expected.
  /// @param share  Prior probability of a change.
  /// @rt No heap, no lock, no throw. O(hypotheses dim^3).
  void AddChanged(double share) noexcept ARMCMC_NONBLOCKING;

  /// FindEnd() for parameters that did not come from where they were: with the velocities that were expected before
  /// the pack, which Learn() then starts again with, too.
  /// @param mean, covariance  Of the effective parameters.
  /// @rt No heap, no lock, no throw. O(dim^3).
  bool FindEndOfChanged(const ParamVector& mean, const ParamMatrix& covariance,
                        std::array<EndOfPack, kMaxParams>* end) const noexcept ARMCMC_NONBLOCKING;

  /// After Carry(): what the pack taught.
  /// @param next     Posterior after it.
  /// @param part     What its first block was fitted to.
  /// @param both     Rest and drift have a block each, with the weights that were sampled.
  /// @param renewed  The parameters did not come from where they were: the bank starts again around `next`, with the
  /// rates that it knows.
  /// @rt No heap, no lock, no throw. O(hypotheses dim^3), and some thousand draws times dim^2.
  void Learn(const ModeData& data, const PosteriorMemory& next, const Draws& draws, Part part, bool both, bool renewed,
             LaplaceScratch* scratch) noexcept ARMCMC_NONBLOCKING;

  /// As of the last Carry(): probability of drift before the pack, and the expected rate of each parameter, prior
  /// standard deviations per second.
  [[nodiscard]] double share() const noexcept { return share_; }
  [[nodiscard]] const std::array<double, kMaxParams>& rate() const noexcept { return rate_; }

  void Forget() noexcept ARMCMC_NONBLOCKING;
  /// Asks for what Carry() reads to be in the cache. @rt O(hypotheses dim^2).
  void Prefetch() const noexcept ARMCMC_NONBLOCKING;
  /// For Restore(), which is bit-identical; a bank of other hypotheses or of fewer slots is passed over.
  void Save(SnapshotWriter* out) const noexcept ARMCMC_NONBLOCKING;
  void Restore(SnapshotReader* in) noexcept ARMCMC_NONBLOCKING;

 private:
  using Filter = DriftFilter;
  /// Slot by slot, in each a filter of every hypothesis; of one hypothesis the one that began last is the first. The
  /// first two are for what changed and what began at the last pack.
  using Bank = std::array<Filter, kFilters>;
  static constexpr std::size_t kChanged = 0, kBegun = 1, kNewcomers = 2;
  struct Moments {
    double weight = 0.0;
    ParamVector mean;
    ParamMatrix covariance;
  };

  [[nodiscard]] static std::size_t HypothesisOf(std::size_t filter) noexcept { return filter % kHypotheses; }
  [[nodiscard]] static std::size_t SlotOf(std::size_t filter) noexcept { return filter / kHypotheses; }
  [[nodiscard]] static bool IsOf(Part part, std::size_t filter) noexcept {
    return part == Part::kWhole || (part == Part::kRest) == (HypothesisOf(filter) == 0);
  }
  [[nodiscard]] bool Exists(std::size_t filter) const noexcept {
    return HypothesisOf(filter) < static_cast<std::size_t>(NumHypotheses(dim_));
  }
  /// @param first  Slot, from which on.
  [[nodiscard]] Moments MomentsOf(const Bank& bank, Part part,
                                  std::size_t first = kChanged) const noexcept ARMCMC_NONBLOCKING;
  /// Empties the slots of newcomers of each hypothesis.
  void MakeRoom(Bank* bank) const noexcept ARMCMC_NONBLOCKING;
  /// Covariance of the velocity that a hypothesis begins with.
  [[nodiscard]] ParamMatrix FirstVelocity(const Hypothesis& law) const noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] Filter Newcomer(const Moments& part, double weight,
                                const Hypothesis& law) const noexcept ARMCMC_NONBLOCKING;
  /// What drifts in `predicted_`, where it stops within a time, at any moment of it. Overwrites `work_`.
  [[nodiscard]] Moments StoppedDrift(double within_s) noexcept ARMCMC_NONBLOCKING;
  /// What begins, ends or becomes another drift within a time, in the slots for it.
  void AddNewcomers(double elapsed_s, double gap_s) noexcept ARMCMC_NONBLOCKING;
  /// What drifts and becomes another drift.
  void TurnDrifts(double elapsed_s) noexcept ARMCMC_NONBLOCKING;
  /// @param gap_s  Part of the elapsed time in which there were no packs.
  void Predict(double elapsed_s, double gap_s) noexcept ARMCMC_NONBLOCKING;
  /// v = u.
  void StandStill() noexcept ARMCMC_NONBLOCKING;
  /// `predicted_` from (u, w) to (v, w), with what the pack tells of w.
  void ToEffective(const ModeData& data, const PosteriorMemory& last,
                   LaplaceScratch* scratch) noexcept ARMCMC_NONBLOCKING;
  /// @param mode  m of the expansion. @param lead  T.
  /// @return false, with nothing changed, where a filter would be no Gaussian.
  bool MoveToEffective(const LocalLikelihood& local, const ParamVector& mode,
                       const ParamMatrix& lead) noexcept ARMCMC_NONBLOCKING;
  /// `bank_` from (v, w) to (u, w).
  void FromEffective() noexcept ARMCMC_NONBLOCKING;
  /// Probability of drift in `predicted_`, and its expected rates.
  void ExpectDrift() noexcept ARMCMC_NONBLOCKING;
  /// Moments of w in `predicted_`. Overwrites `work_`.
  void ExpectVelocity() noexcept ARMCMC_NONBLOCKING;
  void Start(const PosteriorMemory& next, bool with_speeds) noexcept ARMCMC_NONBLOCKING;
  /// A sampled density of a part of the bank.
  struct Sampled {
    Part part;
    ParamVector mean;
    ParamMatrix covariance;
    LocalLikelihood local;  ///< About the mean.
  };
  [[nodiscard]] Sampled SampledBlock(const ModeData& data, const PosteriorMemory& next, int block, Part part,
                                     LaplaceScratch* scratch) const noexcept ARMCMC_NONBLOCKING;
  /// Updates the filters of a part and makes `weight` the sum of theirs.
  /// @return false when some number is not finite.
  bool Update(const Sampled& sampled, Part part, double weight) noexcept ARMCMC_NONBLOCKING;
  /// Of a part, what the expanded likelihood makes of the prior that was sampled: a Gaussian, or the bank itself.
  [[nodiscard]] Moments ByExpansion(const Sampled& sampled) const noexcept ARMCMC_NONBLOCKING;
  using Mixture = NormalMixture<kFilters>;
  /// Marginal d of the filters of a part.
  static void AddFilters(const Bank& bank, Part part, int d, Mixture* to) noexcept ARMCMC_NONBLOCKING;
  /// The bank after a pack.
  void UpdateBank(const ModeData& data, const PosteriorMemory& next, const Draws& draws, Part part, bool both,
                  bool renewed, LaplaceScratch* scratch) noexcept ARMCMC_NONBLOCKING;
  /// The expansion of a part, for Kernels::tilt.
  [[nodiscard]] simd::QuadraticControl ControlOf(const Sampled& sampled,
                                                 const Draws& draws) const noexcept ARMCMC_NONBLOCKING;
  /// Gives what drifts the probability p.
  void SetShare(double p) noexcept ARMCMC_NONBLOCKING;
  /// Probability of drift after a pack, by the bank and what the draws differ from the expansion.
  /// @param tilted  The scratch of the draws has their weights under the expansion.
  [[nodiscard]] double CorrectedShare(const Draws& draws, bool tilted,
                                      double as_sampled) const noexcept ARMCMC_NONBLOCKING;
  /// The weights in the scratch of the draws, as if the expansion were the likelihood.
  /// @return By what factor the number of effective draws changes; 0 if they are too few.
  double Tilt(const Sampled& sampled, const Draws& draws, int count) const noexcept ARMCMC_NONBLOCKING;
  /// To the marginal `end` of the bank, from that of the draws by the weights in their scratch.
  /// @param mean, variance  Of the bank before it was moved to the end of the pack.
  /// @param end_variance    After that.
  [[nodiscard]] EndOfPack EndByDraws(const Draws& draws, int d, double mean, double variance,
                                     const EndOfPack::Quantiles& end,
                                     double end_variance) const noexcept ARMCMC_NONBLOCKING;
  /// Of the draws by the weights in their scratch; `weight` is the effective number.
  [[nodiscard]] Moments MomentsOfDraws(const Draws& draws, int count) const noexcept ARMCMC_NONBLOCKING;
  /// No bound cuts off anything of a Gaussian with these moments.
  [[nodiscard]] bool IsClearOfBounds(const Moments& moments) const noexcept ARMCMC_NONBLOCKING;
  /// Where the filters of a sampled part belong.
  /// @param closed  Where the expansion puts them.
  bool TargetByDraws(const Sampled& sampled, const Draws& draws, const Moments& closed,
                     Moments* target) const noexcept ARMCMC_NONBLOCKING;
  /// Moves and stretches the filters of the sampled part by what the posterior differs from that under the expansion.
  bool Recentre(const Sampled& sampled, const Draws& draws) noexcept ARMCMC_NONBLOCKING;
  /// Block `to` of what is carried on: `source`, of which the parameters x become centre + map (x - from).
  bool Place(const DensityBlock& source, const ParamMatrix& map, const ParamVector& from, const ParamVector& centre,
             int to) noexcept ARMCMC_NONBLOCKING;
  /// Block `to` of what is carried on: that of a change, which time moves and widens as it does the bank.
  bool MoveChanged(const PosteriorMemory& last, const Moments& from, int to) noexcept ARMCMC_NONBLOCKING;
  /// Block `to` of what is carried on: a block of `last`, moved and stretched as from `from` to a part of the bank.
  bool Move(const PosteriorMemory& last, Part part, const Moments& from, int block, int to) noexcept ARMCMC_NONBLOCKING;
  /// Block `to` of what is carried on, of one parameter: the mixture of the hypotheses that drift.
  void Mix(const Moments& part, int to) noexcept ARMCMC_NONBLOCKING;
  bool SetMoments(const PosteriorMemory& last, Part part, const Moments& from) noexcept ARMCMC_NONBLOCKING;

  const simd::Kernels& kernels_;
  int model_;
  const ParameterSpace& space_;
  const NoiseModel& noise_;
  const MarginalTable& normal_table_;
  int dim_;  ///< Parameters; the noise scale, where sampled, comes after them.
  std::array<Hypothesis, kHypotheses> hypotheses_;
  bool enabled_;
  bool started_ = false;
  double time_s_ = 0.0;     ///< Of the pack that `bank_` has learnt from.
  double elapsed_s_ = 0.0;  ///< From that one to the next.
  double gap_s_ = 0.0;      ///< Of that, without packs.
  Bank bank_;               ///< After that pack.
  std::shared_ptr<Scratch> scratch_;
  Bank& predicted_;  ///< Before the next one. Of scratch_.
  Bank& work_;       ///< Of scratch_.
  Expected expected_;
  Expected velocity_;           ///< Before what the pack tells of it.
  bool expects_drift_ = false;  ///< Likewise: drift is not negligible.
  bool moves_ = false;
  ParamMatrix lead_;    ///< T of that pack, s.
  bool leads_ = false;  ///< It is not zero.
  double share_ = 0.0;
  double p_drifted_ = 0.0;  ///< After FindEnd(): posterior probability of drift. Negative: as sampled.
  std::array<double, kMaxParams> rate_{};
  Part fitted_ = Part::kRest;  ///< What the posterior's first block was fitted to.
  bool both_ = false;          ///< Its second block is the other part.
  bool separate_ = false;      ///< Its blocks are two posteriors, without and with a change.
  bool split_ = false;
  bool mixed_ = false;  ///< The part that drifts was carried as the mixture that the bank has.
  int drifting_block_ = 1;
  PosteriorMemory carried_;
};

class Drift::Scratch {
  friend class Drift;
  Bank predicted_, work_;
};

}  // namespace armcmc
