#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "armcmc/estimator_status_t.hpp"

namespace armcmc::stress {

/// Who makes a fault.
enum class FaultSource : std::uint8_t {
  kPlantPlan,      ///< The plant, by --inject.
  kEstimatorPlan,  ///< The estimator itself, by [inject] plan.
  kSignal,         ///< This program, by signals to the processes or messages on the bus.
  kPlantEnd,       ///< This program, by the way in which a plant ends.
};

/// What was seen of one fault.
struct Evidence {
  estimator_status_t before{}, after{};  ///< Last status before the fault, last one of its slot.
  std::int32_t flags = 0;                ///< FAULT_* since the fault that were not in `before`, or are of its step.
  bool modification = false;             ///< An estimate after the fault dropped the past.
  bool log_failure_reported = false;     ///< The plant ended with an error that names its log.

  [[nodiscard]] bool Flag(std::int32_t flag) const { return (flags & flag) != 0; }
  [[nodiscard]] bool Rises(std::int64_t estimator_status_t::*counter) const { return after.*counter > before.*counter; }
  [[nodiscard]] bool Misses() const;  ///< Any deadline missed, or a pack dropped in favour of a newer one.
};

struct FaultSpec {
  const char* name;
  FaultSource source;
  const char* item;         ///< Kind in the plan of the plant or of the estimator, "" for others.
  double periods;           ///< How long it lasts, in periods, and ...
  double milliseconds;      ///< ... at least so long. Both 0: an instant.
  int count;                ///< Messages, for a fault that is counted in those.
  bool misses;              ///< Missed deadlines belong to it.
  bool relearns;            ///< What was learnt is wrong afterwards and is learnt again.
  const char* detected_by;  ///< In words, with the names of status fields and flags.
  bool (*detected)(const Evidence&);

  [[nodiscard]] double LastsMs(double period_ms) const;
  /// Packs that it covers from its first one on; 0 for what a signal does, where it is measured.
  [[nodiscard]] std::int64_t LastsPacks(double period_ms) const;
  /// Its item in a plan at a pack: "late@30:150".
  [[nodiscard]] std::string PlanItem(std::int64_t pack, double period_ms) const;
};

/// All faults, in the order in which they are made.
[[nodiscard]] const std::vector<FaultSpec>& FaultCatalog();

/// The faults of a comma-separated list, "all" or "" for every one, "none" for none.
/// @throws std::invalid_argument naming one that does not exist and all that do.
[[nodiscard]] std::vector<const FaultSpec*> SelectFaults(const std::string& list);

/// Names of the FAULT_* bits that are set, "a|b".
[[nodiscard]] std::string FlagNames(std::int32_t flags);

}  // namespace armcmc::stress
