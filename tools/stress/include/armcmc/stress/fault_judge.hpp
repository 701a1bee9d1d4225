#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "armcmc/estimate_t.hpp"
#include "armcmc/estimator_status_t.hpp"
#include "armcmc/stress/fault_layout.hpp"

namespace armcmc::stress {

/// Steps after a fault within which everything is normal again.
inline constexpr std::int64_t kMostRecoverySteps = 5;

/// What became of one injected fault.
struct FaultOutcome {
  const FaultSpec* fault = nullptr;
  bool injected = false;  ///< false: it never came to it, or the machine had swallowed its pack or its status.
  bool detected = false;
  std::int32_t flags = 0;
  std::int64_t recovered_steps = 0;  ///< Steps after the fault until the first normal one, those of stalls not counted.
  std::int64_t stalled_steps =
      0;  ///< Steps that were not counted: the machine stood still, data came late, or we did not hear.
  std::int64_t own_misses = 0;  ///< In its slot.
  const char* hindrance = "";   ///< What was not normal at the last step that was not.
  std::int64_t statuses = 0;    ///< Heard in its slot.
};

/// Watches the estimator's messages of one run of the plant after another and judges every slot.
///
/// A step is normal when its estimate came, its status raises no flag that was not there before the fault, its
/// deadline was kept, and its estimate agrees with the one before the fault: inside its 95 % interval or within two
/// joint standard deviations, with an interval at most four times as wide (unless the fault makes it learn again).
/// While the data flow on during a long fault the estimate moves with them: then every step on time must agree so with
/// the one before it, and the interval be no wider than so since the beginning.
/// Memory is bounded by the length of a slot.
class FaultJudge {
 public:
  static constexpr std::int64_t kNever = 99;  ///< recovered_steps of what did not become normal in its slot.

  explicit FaultJudge(std::int64_t period_ns) : period_ns_(period_ns) {}

  /// A new run of the plant begins; its packs count from 1. Steps are taken from its first estimate on.
  void BeginRun(std::vector<Slot> slots);
  void OnEstimate(const estimate_t& estimate);
  void OnStatus(const estimator_status_t& status);

  /// The fault of the present slot, made from outside, begins now (after `newest` packs) ...
  void SignalBegins();
  /// ... and is over now, after this pack.
  void SignalEnds(std::int64_t newest);
  /// What the plant said at its end belongs to the present slot.
  void LogFailureReported() { evidence_.log_failure_reported = true; }

  /// The slot that a pack number of this run lies in; nullptr between them.
  [[nodiscard]] const Slot* current() const { return next_ < slots_.size() ? &slots_[next_] : nullptr; }
  [[nodiscard]] bool run_started() const { return started_; }
  [[nodiscard]] bool finished() const { return next_ >= slots_.size(); }
  [[nodiscard]] std::vector<FaultOutcome> TakeOutcomes();
  [[nodiscard]] const estimator_status_t& newest_status() const { return last_status_; }

 private:
  struct Step {
    bool has_estimate = false, has_status = false;
    bool truncated = false, modification = false;
    std::array<double, 3> value{}, lo{}, hi{}, sd{};
    std::int32_t flags = 0, miss = 0;
    std::int64_t dropped = 0;   // packs given up in favour of this one
    std::int64_t not_ours = 0;  // steps up to this one that the machine, or late data, or our own ears swallowed
  };

  void FinishSlot();
  [[nodiscard]] bool IsBefore(const estimator_status_t& status, const Slot& slot) const;
  [[nodiscard]] std::int64_t NotOwn(const estimator_status_t& status) const;
  /// Packs given up right after this one, which its status may tell already.
  [[nodiscard]] std::int64_t DroppedRightAfter(std::int64_t seq) const;
  /// The estimate to compare with after steps in which the data flowed on.
  [[nodiscard]] Step Followed(std::int64_t first, std::int64_t last) const;
  [[nodiscard]] bool Agrees(const Step& step, const Step& reference, bool relearns) const;
  /// nullptr for a normal step, else what it lacks.
  [[nodiscard]] const char* ReasonNotNormal(const Step& step, const Step& reference, const FaultSpec& fault) const;

  std::int64_t period_ns_;
  std::vector<Slot> slots_;
  std::size_t next_ = 0;
  bool started_ = false, any_estimate_ = false;
  std::int64_t run_id_ = 0, last_run_id_ = 0;
  std::map<std::int64_t, Step> steps_;
  Step reference_, last_step_;
  std::int64_t newest_seq_ = 0, newest_release_ns_ = 0;  // of the newest estimate
  estimator_status_t last_status_{};
  Evidence evidence_;
  bool has_before_ = false;
  std::int32_t background_ = 0;  // flags before the fault
  std::int32_t raised_ = 0;      // flags since
  std::int64_t unheard_ = 0;     // statuses that did not come since
  std::int64_t statuses_ = 0;    // heard in this slot
  bool signalled_ = false;
  std::int64_t affected_until_ = 0;
  std::vector<FaultOutcome> outcomes_;
};

}  // namespace armcmc::stress
