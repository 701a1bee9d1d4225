#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string_view>

#include "armcmc/data_pack.hpp"
#include "armcmc/estimate.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/settings.hpp"
#include "armcmc/status.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

class AdjustResult;  // draws, weights and meta data of one adjusted pack; see adjust_result.hpp

/// Upper bounds on the draws of each mode, to repeat a run that a deadline had cut.
using DrawLimits = std::array<int, kMaxModes>;
inline constexpr DrawLimits kNoDrawLimits = {kMaxDraws, kMaxDraws, kMaxDraws, kMaxDraws};

/// Name and unit of a reported quantity.
struct ReportedQuantity {
  std::string_view name;
  std::string_view unit;
};

/// Adaptive recursive MCMC, P(theta | D^1..D^t) ~ L(D^t | theta) prior_t(theta): adjust and execute of the three-stage
/// loop. Source: P. Agand, M. Chen, H. D. Taghirad, Online probabilistic model identification using adaptive recursive
/// MCMC, IJCNN 2023; core/README.md lists the differences. Adjust() and Execute() may run at the same time on two
/// threads if they work on different AdjustResults: Adjust() alone changes the posterior memory, Execute() alone the
/// predictor state. No clock, thread or I/O inside; memory is fixed after construction.
class Estimator {
 public:
  /// @throws std::invalid_argument from settings.Validate(). Allocates all memory that it will ever use.
  explicit Estimator(const EstimatorSettings& settings);
  /// Shares the scratch memory, which is most of an estimator's memory, with another one of the same model and sampler
  /// that outlives this. Only one of the two may adjust at a time, and only one execute; Remember() must precede the
  /// other's Draw().
  /// @throws std::invalid_argument from settings.Validate().
  Estimator(const EstimatorSettings& settings, const Estimator& lender);
  ~Estimator();
  Estimator(const Estimator&) = delete;
  Estimator& operator=(const Estimator&) = delete;

  /// A result slot of the right size for this estimator. Allocates.
  [[nodiscard]] std::unique_ptr<AdjustResult> MakeResult() const;

  /// Stage B of the paper's timeline: mismatch, lambda, k_min, draws, posterior.
  ///
  /// Draws stop when the predicted end of the next chunk would pass deadline_ns. For equal settings, equal
  /// packs and equal draw counts the result is bit-identical.
  /// @param pack         Checked here; num_inputs() columns of u at least.
  /// @param deadline_ns  Absolute, on the clock passed in; a default clock never reaches it.
  /// @param clock        Read between chunks of draws.
  /// @param result       Of MakeResult() of this estimator, or of one with the same settings.
  /// @param limits       Upper bounds on the draws, for a run that is repeated.
  /// @return kOk, kTruncated, kHeld, kBadPack (nothing changed) or kNonFinite (posterior kept).
  /// @rt No heap, no lock, no throw. Bounded by max_draws x num_samples.
  Status Adjust(const DataPack& pack, Nanos deadline_ns, ClockRef clock, AdjustResult* result,
                const DrawLimits& limits = kNoDrawLimits) noexcept ARMCMC_NONBLOCKING;

  /// Adjust() in two parts, so that a result need not wait for work that only the next pack needs: Draw() fills it, and
  /// while another thread reads it Remember() turns its draws into the posterior that the next pack starts from. The
  /// result must not change until then; the next Draw() makes up for a Remember() that was skipped.
  /// @return as Adjust(). @rt As Adjust().
  Status Draw(const DataPack& pack, Nanos deadline_ns, ClockRef clock, AdjustResult* result,
              const DrawLimits& limits = kNoDrawLimits) noexcept ARMCMC_NONBLOCKING;
  /// @param clock  Of that Draw(). @rt No heap, no lock, no throw. O(max_draws).
  void Remember(ClockRef clock) noexcept ARMCMC_NONBLOCKING;
  /// Asks for what the next Draw() reads of this estimator's own memory to be in the cache: of several that take turns,
  /// each displaces that of the others. @rt No heap, no lock, no throw. O(tables of the posterior).
  void Prefetch() const noexcept ARMCMC_NONBLOCKING;

  /// Stage C: summary of the posterior, predicted output with band.
  /// @rt No heap, no lock, no throw. O(draws).
  void Execute(const AdjustResult& result, Estimate* estimate) noexcept ARMCMC_NONBLOCKING;

  /// Prediction of a pack of a described plant by the posterior before it, for every sample n of a mode that an earlier
  /// pack has updated (NaN elsewhere, and for a compiled plant):
  ///
  ///     centre = median of F(X_n, theta_k) over a thinned chain theta_k of that posterior,
  ///     sd^2   = (half the range of its middle two thirds)^2 + noise_std^2 (S P S')_nn,
  ///
  /// theta_k mapped to the mean and covariance that the estimated drift has produced since then, P the covariance of
  /// the plant's states at the start of the pack, S the sensitivity of the law to them (StateFilter). The median is
  /// used because a power whose exponent is not known yet has no meaningful mean.
  /// Residuals against it are one-pack-ahead prediction errors: nothing was fitted to the predicted data.
  /// @param result  Of Adjust() for the newest pack, before Execute() has seen it.
  /// @param forecast  Centre and sd of each sample.
  /// @rt No heap, no lock, no throw; O(samples). While neither Adjust() nor Execute() runs.
  void Forecast(const AdjustResult& result, PackForecast* forecast) noexcept ARMCMC_NONBLOCKING;

  /// What the gap watch has found, as the newest Execute() left it. @rt O(1). While Execute() does not run.
  [[nodiscard]] const GapState& gap() const noexcept ARMCMC_NONBLOCKING;

  /// Forgets everything learnt: the next pack is combined with the initial prior. (A restarted plant is not a
  /// reason to call it: the mismatch test decides whether the old posterior still holds.)
  void Reset() noexcept ARMCMC_NONBLOCKING;

  /// Bytes that one of the two Save functions may need, with as many modes and parameters as there may be.
  static constexpr std::size_t kSnapshotBytes = 1536 * 1024;
  /// What Adjust() carries from pack to pack, the posteriors of all modes, and what Execute() carries: the estimates on
  /// display and the evidence of the gap watch. Each is called by the thread of its stage, the first after Remember().
  /// A restored estimator continues bit-identically; what only spans neighbouring packs (memory of effects, a free
  /// run, the unfinished block of the gap watch) starts afresh, as after a lost pack.
  /// @param out  At least kSnapshotBytes. @return bytes written, 0 if they did not fit.
  /// @rt No heap, no lock, no throw. O(kSnapshotBytes).
  [[nodiscard]] std::size_t SaveAdjusted(std::span<std::byte> out) const noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] std::size_t SaveExecuted(std::span<std::byte> out) const noexcept ARMCMC_NONBLOCKING;
  /// Continues from what was saved by an estimator with the same SnapshotIdentity().
  /// @return false when it is damaged: everything is forgotten then, as by Reset().
  /// @rt No heap, no lock, no throw; while neither Adjust() nor Execute() runs.
  [[nodiscard]] bool Restore(std::span<const std::byte> adjusted,
                             std::span<const std::byte> executed) noexcept ARMCMC_NONBLOCKING;

  [[nodiscard]] const EstimatorSettings& settings() const noexcept ARMCMC_NONBLOCKING;
  /// Unit of what is regressed, and so of the noise.
  [[nodiscard]] std::string_view target_unit() const noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] PlantNumber plant() const noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] int num_modes() const noexcept ARMCMC_NONBLOCKING;
  /// mode == num_modes(): the passive one.
  [[nodiscard]] std::string_view mode_name(int mode) const noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] int num_reported() const noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] ReportedQuantity reported(int index) const noexcept ARMCMC_NONBLOCKING;
  /// Whether the gap watch is on: enabled, and able to watch this plant (see GapWatch).
  [[nodiscard]] bool watches_gap() const noexcept;
  /// Name of a check of the gap watch by its index in GapState, as long as the estimator lives; empty for none.
  [[nodiscard]] std::string_view gap_check_name(int check) const noexcept;
  [[nodiscard]] int num_inputs() const noexcept ARMCMC_NONBLOCKING;  ///< Columns of u that a pack must have.

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Instruction set that the scoring kernels run on: "avx512", "avx2" or "sse2" on x86-64, "neon" or
/// "portable" on AArch64, "portable" elsewhere.
[[nodiscard]] std::string_view InstructionSet() noexcept;

/// Makes the estimators that are constructed from now on use that instruction set, for measurements; otherwise it is
/// the widest that this CPU runs. @return false when this build or this CPU has no such set: nothing is changed then.
/// @rt Set-up only: while no other thread constructs an estimator.
[[nodiscard]] bool UseInstructionSet(std::string_view name) noexcept;

}  // namespace armcmc
