#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "armcmc/data_pack.hpp"
#include "armcmc/estimate.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/interleaved_estimator.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/latest_value.hpp"
#include "armcmc/rt/pack_format.hpp"
#include "armcmc/rt/snapshot_hand_over.hpp"
#include "armcmc/status.hpp"
#include "armcmc/types.hpp"

namespace armcmc::rt {

/// The computation that the pipeline drives: adjust and execute on results that it keeps in LatestValue::kSlots slots.
///
/// The pipeline refers to results by their slot number, so that draws are never copied. Adjust() and Execute() run at
/// the same time on two threads, on different slots; an implementation keeps what they share immutable. EstimatorEngine
/// is the implementation for service; tests use fake ones. Names and units that it returns live as long as the engine.
class StepEngine {
 public:
  virtual ~StepEngine() = default;

  /// Type, plant and number of signals of the packs that it takes. The name in it lives as long as the engine.
  [[nodiscard]] virtual PackFormat pack_format() const noexcept ARMCMC_NONBLOCKING = 0;
  /// Plant number of its packs.
  [[nodiscard]] PlantNumber plant() const noexcept ARMCMC_NONBLOCKING { return pack_format().plant; }
  /// Number of modes, 1 to kMaxModes.
  [[nodiscard]] virtual int num_modes() const noexcept ARMCMC_NONBLOCKING = 0;
  /// Number of reported quantities of a mode, 1 to kMaxReported.
  [[nodiscard]] virtual int num_reported() const noexcept ARMCMC_NONBLOCKING = 0;
  /// Name and unit of a reported quantity. @param index  In [0, num_reported()).
  [[nodiscard]] virtual ReportedQuantity reported(int index) const noexcept ARMCMC_NONBLOCKING = 0;
  /// Name of a mode. @param mode  In [0, num_modes()).
  [[nodiscard]] virtual std::string_view mode_name(int mode) const noexcept ARMCMC_NONBLOCKING = 0;

  /// Computes the posterior after `pack` into a slot, and stops before the deadline with fewer draws if necessary.
  /// @param pack         Checked by collect.
  /// @param deadline_ns  Absolute, on `clock`.
  /// @param clock        Monotonic.
  /// @param slot         In [0, LatestValue::kSlots); owned by adjust.
  /// @return kOk, kTruncated, kHeld, or an error after which the previous posterior is kept.
  /// @rt No heap, no lock, no throw. O(draws).
  virtual Status Adjust(const DataPack& pack, Nanos deadline_ns, ClockRef clock,
                        int slot) noexcept ARMCMC_NONBLOCKING = 0;
  /// Work of the newest Adjust() that only the next one needs, done after its slot was handed over. Called by the
  /// thread of Adjust(), before that slot is written again.
  /// @rt No heap, no lock, no throw. O(draws).
  virtual void Remember(ClockRef clock) noexcept ARMCMC_NONBLOCKING = 0;
  /// Summarises a slot: estimate, intervals, prediction, gap watch. @rt No heap, no lock, no throw. O(draws).
  virtual void Execute(int slot, Estimate* estimate) noexcept ARMCMC_NONBLOCKING = 0;
  /// Returns to the initial state. Ends the warm-up, whose packs must not leave a trace. Called before the first pack,
  /// while neither Adjust() nor Execute() runs.
  virtual void Reset() noexcept ARMCMC_NONBLOCKING = 0;
};

/// Format of the packs that an estimator takes. The name in it lives as long as the estimator.
[[nodiscard]] PackFormat PackFormatOf(const Estimator& estimator) noexcept ARMCMC_NONBLOCKING;

/// The estimator of core as a StepEngine: one recursion, or as many interleaved ones as packs overlap. All results and
/// scratch memory are allocated at construction.
class EstimatorEngine final : public StepEngine {
 public:
  /// @throws std::invalid_argument from the settings. Allocates all memory.
  explicit EstimatorEngine(const EstimatorSettings& settings);
  ~EstimatorEngine() override;

  /// See StepEngine. Adjust() draws, Remember() saves the new posterior for the next pack and for the snapshot.
  [[nodiscard]] PackFormat pack_format() const noexcept ARMCMC_NONBLOCKING override;
  [[nodiscard]] int num_modes() const noexcept ARMCMC_NONBLOCKING override;
  [[nodiscard]] int num_reported() const noexcept ARMCMC_NONBLOCKING override;
  [[nodiscard]] ReportedQuantity reported(int index) const noexcept ARMCMC_NONBLOCKING override;
  [[nodiscard]] std::string_view mode_name(int mode) const noexcept ARMCMC_NONBLOCKING override;
  Status Adjust(const DataPack& pack, Nanos deadline_ns, ClockRef clock, int slot) noexcept ARMCMC_NONBLOCKING override;
  void Remember(ClockRef clock) noexcept ARMCMC_NONBLOCKING override;
  void Execute(int slot, Estimate* estimate) noexcept ARMCMC_NONBLOCKING override;
  void Reset() noexcept ARMCMC_NONBLOCKING override;

  /// Hands the state of the estimator to another thread after every step. Before the pipeline starts.
  /// @param snapshots  Of Estimator::kSnapshotBytes for each of estimator().settings().overlap recursions; outlives the
  ///                   engine.
  void SetSnapshots(SnapshotHandOver* snapshots) noexcept { snapshots_ = snapshots; }
  /// Goes on from what an engine of the same SnapshotIdentity() has saved; kept, so that Reset(), which ends the
  /// warm-up, comes back to it. Before the pipeline starts.
  /// @param adjusted, executed  JoinParts() of the parts that were handed over.
  /// @return false when it is damaged: starts afresh.
  [[nodiscard]] bool Resume(std::span<const std::byte> adjusted, std::span<const std::byte> executed);

  /// For names, units and settings; where packs overlap, the first of the recursions.
  [[nodiscard]] const Estimator& estimator() const noexcept { return estimator_.first(); }

 private:
  /// Restores every recursion from the bytes that Resume() was given; true without them.
  [[nodiscard]] bool RestoreResumed() noexcept ARMCMC_NONBLOCKING;

  InterleavedEstimator estimator_;  ///< One recursion, or as many as packs overlap.
  std::array<std::unique_ptr<AdjustResult>, LatestValue::kSlots> results_;
  SnapshotHandOver* snapshots_ = nullptr;
  bool warm_ = false;     // snapshots of the warm-up are not handed over
  bool learnt_ = false;   // by the newest Adjust()
  std::int64_t seq_ = 0;  ///< Number of the newest pack.
  std::vector<std::vector<std::byte>> resumed_adjusted_, resumed_executed_;  // by recursion
};

}  // namespace armcmc::rt
