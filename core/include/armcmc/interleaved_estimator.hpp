#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "armcmc/adjust_result.hpp"
#include "armcmc/estimator.hpp"

namespace armcmc {

/// An estimate from every pack where packs overlap, with every sample counted once.
///
/// A pack has N samples, and the next one begins N / L samples later, L = EstimatorSettings::overlap. L recursions take
/// turns:
///
///     recursion j  takes the packs with  seq mod L = j
///
/// Two packs of one recursion are N samples apart: its windows tile the time axis. So its posterior is that of all
/// samples from its first window on, each counted once, and the one of pack seq, which is published, reaches up to the
/// newest sample. The first windows begin up to N - N / L samples after the first sample of all.
///
/// One of them, the recursion of seq mod L = 0, runs the gap watch: its packs hold every sample, and the rate of false
/// alarms remains the configured one. Its state is shown with every pack.
///
/// With L = 1 it is bit-identical to one Estimator. The interface is that of Estimator, with the same rules: Adjust()
/// and Execute() may run at the same time on two threads.
class InterleavedEstimator {
 public:
  /// @throws std::invalid_argument from settings.Validate(). Allocates all memory that it will ever use: one scratch,
  /// and what each recursion has learnt.
  explicit InterleavedEstimator(const EstimatorSettings& settings);

  /// As Estimator::MakeResult(): for the packs of every recursion. Allocates.
  [[nodiscard]] std::unique_ptr<AdjustResult> MakeResult() const { return estimators_.front()->MakeResult(); }

  /// As Estimator::Adjust(), by the recursion whose turn the pack is.
  Status Adjust(const DataPack& pack, Nanos deadline_ns, ClockRef clock, AdjustResult* result,
                const DrawLimits& limits = kNoDrawLimits) noexcept ARMCMC_NONBLOCKING;
  /// As Estimator::Draw(). Makes up for a Remember() of another recursion that was left out.
  Status Draw(const DataPack& pack, Nanos deadline_ns, ClockRef clock, AdjustResult* result,
              const DrawLimits& limits = kNoDrawLimits) noexcept ARMCMC_NONBLOCKING;
  /// As Estimator::Remember(), of the newest Draw().
  void Remember(ClockRef clock) noexcept ARMCMC_NONBLOCKING;
  /// As Estimator::Execute().
  void Execute(const AdjustResult& result, Estimate* estimate) noexcept ARMCMC_NONBLOCKING;
  /// As Estimator::Forecast(): the prediction by the recursion of the pack, which has seen none of its samples.
  void Forecast(const AdjustResult& result, PackForecast* forecast) noexcept ARMCMC_NONBLOCKING;
  /// Forgets everything learnt by all recursions.
  void Reset() noexcept ARMCMC_NONBLOCKING;

  /// Which recursion takes a pack: seq mod L.
  [[nodiscard]] int TurnOf(std::int64_t seq) const noexcept ARMCMC_NONBLOCKING;
  /// Recursion j, for its snapshots: Estimator::SaveAdjusted() and so on, with the same rules. When each has been
  /// restored, the packs that follow give bit-identical estimates.
  /// @pre 0 <= j < overlap().
  [[nodiscard]] Estimator& recursion(int j) noexcept ARMCMC_NONBLOCKING {
    return *estimators_[static_cast<std::size_t>(j)];
  }
  /// The one that watches for a gap, and with L = 1 the only one: for names, units and the gap watch.
  [[nodiscard]] const Estimator& first() const noexcept ARMCMC_NONBLOCKING { return *estimators_.front(); }
  [[nodiscard]] Estimator& first() noexcept ARMCMC_NONBLOCKING { return *estimators_.front(); }
  [[nodiscard]] int overlap() const noexcept ARMCMC_NONBLOCKING { return static_cast<int>(estimators_.size()); }

 private:
  [[nodiscard]] Estimator& Of(std::int64_t seq) noexcept ARMCMC_NONBLOCKING { return recursion(TurnOf(seq)); }

  std::vector<std::unique_ptr<Estimator>> estimators_;  ///< [seq mod L].
  int turn_ = 0;                                        ///< Of which of them the newest Draw() was.
};

}  // namespace armcmc
