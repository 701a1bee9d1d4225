#pragma once

#include <array>
#include <cstdint>

#include "armcmc/drift_factor.hpp"
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

/// Drift of the parameters of one mode, learnt from the packs.
///
/// Under hypothesis h the standardised parameters u move along straight lines, each in a direction of its own:
///
///   du/dt = w,   w ~ N(0, s_h^2)
///
/// s_h is the rate, in prior standard deviations per second, the same for all parameters. h = 0 is "rest", s = 0. What
/// rests begins to drift, and what drifts comes to rest (kSwitching) or turns: rate and velocity are then drawn anew
/// (kTurning). A velocity that wandered instead, as an Ornstein-Uhlenbeck process does, would never be known well on a
/// path that is straight for long.
///
/// The posterior of h and the split of u among them are a bank of Gaussian filters in (u, w), in closed form:
///
///   time     of what rests a part s (1 - e^{-kappa dt}), s the prior probability of drift, begins to drift, with a
///            velocity of its own; of what drifts a part (1 - s) (1 - e^{-kappa dt}) comes to rest, and of what goes on
///            a part 1 - e^{-kappa_t dt} turns. Then u <- u + w dt
///   gaps     a pack follows what drifts for its own duration. In the time before that no turn would show: every filter
///            gets the moments of a path that turns on and on, whose velocity has the autocovariance s^2 e^{-kappa_t t}
///   age      it takes many packs to tell when a drift began, and how fast it is depends on that. So each hypothesis
///   has
///            kSlots filters in the order in which they began. To make room for the next one, those two neighbours are
///            merged whose merging (by matching moments) loses least: W log|C| - w_1 log|C_1| - w_2 log|C_2|, an upper
///            bound of the divergence (Runnalls 2007). Merged by age alone, old ones that still differ would be merged
///            and recent ones that are equal would not
///   bounds   if the variance of a parameter would exceed that of P_0 by a factor c > 1, variance and mean are divided
///            by c: after a long time without information a drifting parameter returns to P_0
///   pack     log L(z) = g' z - z' H z / 2 of z = (u - m, w) about the posterior mean m, H the Fisher information (see
///            LocalLikelihood); pi_h times the evidence of that, with every filter updated by the same g, H, m
///   sampled  the sampled part (rest, drift, or the whole bank) is corrected by the affine map from the posterior
///            according to this expansion to the sampled posterior; for a linear law that is the identity. A part that
///            was not sampled keeps the result of its own filters: the draws of a part that the data refute carry no
///            information about it
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
/// (With a sampled noise scale P_drift is an affine map of P, too.) While drift is improbable (kNegligible), P is
/// unchanged to the bit.
///
/// Parameters also drift while a pack is recorded: u is where they stand at the end of the pack, and u - w t is where
/// they were at a time t before. Taken for constant, they would bias what the pack says along directions that the
/// samples hardly determine, by many standard deviations. DriftFactor corrects the likelihood of the candidates for
/// that, with w | u as the moments of the part that drifts have it. Parameters that changed are constant in the pack
/// that shows the change, and so are all of a law with states.
///
/// The noise scale is not a coordinate of the bank: its memory is wide enough (ModeSampler::AppendNoiseScale).
class Drift {
 public:
  /// s: prior standard deviations per s, alike in probability.
  static constexpr std::array<double, 5> kRates{0.003, 0.01, 0.03, 0.1, 0.3};
  static constexpr double kSwitching = 0.03;   ///< kappa, 1/s: a drift begins or ends.
  static constexpr double kTurning = 0.014;    ///< kappa_t, 1/s: what drifts turns.
  static constexpr double kNegligible = 0.02;  ///< Probability below which a part is left out of the prior of a pack.
  static constexpr int kHypotheses = 1 + static_cast<int>(kRates.size());
  static constexpr int kSlots = 5;  ///< Of a hypothesis.
  static constexpr int kFilters = kSlots * kHypotheses;

  /// Of what the bank holds.
  enum class Part : std::uint8_t { kWhole, kRest, kDrift };

  struct Hypothesis {
    double rate = 0.0, prior = 1.0;
  };
  /// Hypothesis h where drift has the probability `share`.
  [[nodiscard]] static Hypothesis Of(int h, double share) noexcept ARMCMC_NONBLOCKING;

  /// @param share  Prior probability that the plant drifts, in [0, 1). 0: it rests, and Carry() changes nothing.
  Drift(const simd::Kernels& kernels, int model, const ParameterSpace& space, const NoiseModel& noise, double share);

  /// How many times wider the posterior after the last pack has become by a time at which nothing new is known: the
  /// root mean square distance of each parameter in the bank from the mean that it had then, over its standard
  /// deviation then. 1 where it is narrower, and for all of them while drift is improbable (kNegligible).
  /// @param time_s  Plant time, s.
  /// @rt No heap, no lock, no throw. O(hypotheses dim^2).
  void Widening(double time_s, const PosteriorMemory& last,
                std::array<double, kMaxParams>* ratio) noexcept ARMCMC_NONBLOCKING;

  /// What the posterior after the last pack has become by the time of this one.
  /// @return `last`, or a memory of this object, valid until the next call.
  /// @rt No heap, no lock, no throw. O(hypotheses dim^2 + dim^3).
  const PosteriorMemory& Carry(const ModeData& data, const PosteriorMemory& last) noexcept ARMCMC_NONBLOCKING;
  /// Whether `memory` is one posterior at rest and drifting, and not two posteriors.
  [[nodiscard]] bool Splits(const PosteriorMemory& memory) const noexcept { return &memory == &carried_ && split_; }
  /// Of what is not split.
  [[nodiscard]] Part CarriedPart() const noexcept ARMCMC_NONBLOCKING;
  /// Which block of a memory that is split drifts.
  [[nodiscard]] int drifting_block() const noexcept { return drifting_block_; }

  /// Whether block b of what Carry() returned is of parameters that drift, also while the pack is recorded.
  [[nodiscard]] bool Drifts(const PosteriorMemory& memory, int block) const noexcept ARMCMC_NONBLOCKING;
  /// The posterior of those, in place of one under which the parameters are constant in the pack.
  /// @param local     The pack about fit->mean.
  /// @param[in,out] fit     In: its mean and precision under constant parameters.
  /// @param[out] factor     All but `lever` and `log_scale`.
  /// @return false, and both as they were, when some number is not finite.
  /// @rt No heap, no lock, no throw. O(dim^3).
  bool LetDrift(const LocalLikelihood& local, Gaussian* fit, DriftFactor* factor) const noexcept ARMCMC_NONBLOCKING;

  /// After Carry(): what the pack taught.
  /// @param next     Posterior after it.
  /// @param part     What its first block was fitted to.
  /// @param both     Rest and drift have a block each, with the weights that were sampled.
  /// @param renewed  The parameters did not come from where they were: the bank starts again around `next`, with the
  /// rates that it knows.
  /// @rt No heap, no lock, no throw. O(hypotheses dim^3).
  void Learn(const ModeData& data, const PosteriorMemory& next, Part part, bool both, bool renewed,
             LaplaceScratch* scratch) noexcept ARMCMC_NONBLOCKING;

  /// As of the last Carry(): probability of drift before the pack, and the expected rate, prior standard deviations per
  /// second.
  [[nodiscard]] double share() const noexcept { return share_; }
  [[nodiscard]] double rate() const noexcept { return rate_; }

  void Forget() noexcept ARMCMC_NONBLOCKING;
  /// For Restore(), which is bit-identical.
  void Save(SnapshotWriter* out) const noexcept ARMCMC_NONBLOCKING;
  void Restore(SnapshotReader* in) noexcept ARMCMC_NONBLOCKING;

 private:
  /// Mean and covariance of u and w, in blocks; `weight` is its part of pi_h. 0: empty, the rest says nothing.
  struct Filter {
    double weight = 0.0;
    ParamVector u, w;
    ParamMatrix uu, uw, ww;
  };
  /// Slot by slot, what began latest first: in each a filter of every hypothesis.
  using Bank = std::array<Filter, kFilters>;
  struct Moments {
    double weight = 0.0;
    ParamVector mean;
    ParamMatrix covariance;
  };

  [[nodiscard]] static std::size_t HypothesisOf(std::size_t filter) noexcept { return filter % kHypotheses; }
  [[nodiscard]] static bool IsOf(Part part, std::size_t filter) noexcept {
    return part == Part::kWhole || (part == Part::kRest) == (HypothesisOf(filter) == 0);
  }
  [[nodiscard]] static Moments MomentsOf(const Bank& bank, Part part) noexcept ARMCMC_NONBLOCKING;
  /// One filter with the moments of a part of the bank.
  [[nodiscard]] static Filter JointOf(const Bank& bank, Part part) noexcept ARMCMC_NONBLOCKING;
  /// Moves the moments of `from` into `to`, and empties it.
  static void Merge(Filter* from, Filter* to) noexcept ARMCMC_NONBLOCKING;
  /// Bayes' rule for one filter. @param about  Where the likelihood was expanded.
  /// @param moves  Also within the pack.
  /// @return log of the evidence; NaN when some number is not finite.
  [[nodiscard]] static double Observe(const LocalLikelihood& local, const ParamVector& about, bool moves,
                                      Filter* filter) noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] static double ObserveStill(const LocalLikelihood& local, const ParamVector& about,
                                           Filter* filter) noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] static double ObserveMoving(const LocalLikelihood& local, const ParamVector& about,
                                            Filter* filter) noexcept ARMCMC_NONBLOCKING;
  /// log det of the covariance of u, and w if it moves. 0 of an empty filter.
  [[nodiscard]] static double LogVolume(const Filter& filter, bool moves) noexcept ARMCMC_NONBLOCKING;
  /// Empties the first slot of each hypothesis.
  void MakeRoom() noexcept ARMCMC_NONBLOCKING;
  /// Members that have become what they are within the time elapsed. @param turned  Part of what goes on drifting.
  void AddNewcomers(double elapsed_s, double turned) noexcept ARMCMC_NONBLOCKING;
  /// u and w of one filter after a time without a turn.
  void GoStraight(double elapsed_s, Filter* filter) const noexcept ARMCMC_NONBLOCKING;
  /// After a time with any number of turns, the rate being kept: by its moments.
  void GoOnTurning(double rate, double elapsed_s, Filter* filter) const noexcept ARMCMC_NONBLOCKING;
  /// @param variance  Of u, before it grew.
  static void KeepWithin(const ParamVector& variance, Filter* filter) noexcept ARMCMC_NONBLOCKING;
  /// @param recorded  A pack follows what happens.
  void Pass(double elapsed_s, bool recorded) noexcept ARMCMC_NONBLOCKING;
  /// @param pack_s  Duration of a pack at the end of the time elapsed; 0: none.
  void Predict(double elapsed_s, double pack_s) noexcept ARMCMC_NONBLOCKING;
  /// Probability of drift in `predicted_`, and its expected rate.
  void ExpectDrift() noexcept ARMCMC_NONBLOCKING;
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
  /// Moves and stretches the filters of the sampled part to where it was sampled.
  bool Recentre(const Sampled& sampled) noexcept ARMCMC_NONBLOCKING;
  /// Block `to` of what is carried on: a block of `last`, moved and stretched as from `from` to a part of the bank.
  bool Move(const PosteriorMemory& last, Part part, const Moments& from, int block, int to) noexcept ARMCMC_NONBLOCKING;
  /// Block `to` of what is carried on, of one parameter: the mixture of the hypotheses that drift.
  void Mix(const Moments& part, int to) noexcept ARMCMC_NONBLOCKING;
  bool SetMoments(const PosteriorMemory& last, Part part, const Moments& from) noexcept ARMCMC_NONBLOCKING;

  const simd::Kernels& kernels_;
  int model_;
  const ParameterSpace& space_;
  const NoiseModel& noise_;
  MarginalTable normal_table_;
  int dim_;  ///< Parameters; the noise scale, where sampled, comes after them.
  std::array<Hypothesis, kHypotheses> hypotheses_;
  bool enabled_;
  bool started_ = false;
  double time_s_ = 0.0;  ///< Of the pack that `bank_` has learnt from.
  Bank bank_;            ///< After that pack.
  Bank predicted_;       ///< Before the next one.
  double share_ = 0.0, rate_ = 0.0;
  Part fitted_ = Part::kRest;  ///< What the posterior's first block was fitted to.
  bool both_ = false;          ///< Its second block is the other part.
  bool split_ = false;
  bool mixed_ = false;  ///< The part that drifts was carried as the mixture that the bank has.
  int drifting_block_ = 1;
  Filter drifting_;  ///< Moments of the part of `predicted_` that drifts.
  PosteriorMemory carried_;
};

}  // namespace armcmc
