#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/recording.hpp"
#include "armcmc/gap/result.hpp"
#include "armcmc/models/registry.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::gap {

/// The steps after which a run may stop.
enum class Step { kCompare, kFind, kName, kAdd, kShow };

struct WorkflowRequest {
  std::string model = DefaultModel();  ///< Built-in name.
  Recording data;                      ///< To diagnose; without `heldout`, its end is held out.
  std::optional<Recording> heldout;    ///< Separate held-out data.
  std::optional<Recording> earlier;    ///< A tie in its verdict is resolved with both recordings, see Join.
  Step until = Step::kShow;
  DiagnoseOptions diagnose;
  /// Called at the start of each step with its name and the share of the work that is done.
  std::function<void(const std::string&, double)> progress;
};

/// The result of a run, for the writers of files.
struct WorkflowOutcome {
  Result result;
  std::optional<EstimatorSettings> augmented;  ///< If an effect was named.
};

/// Fit and compare, localise, name, add, verify. Deterministic for a seed.
/// @throws std::invalid_argument, with the reason, if the data are unsuitable.
[[nodiscard]] WorkflowOutcome RunWorkflow(const WorkflowRequest& request);

/// The workflow for a recording that RunWorkflow leaves unnamed, where the law may err (DiagnoseOptions::law_errs).
/// @return nothing if no effect stands out beside the error of the law, or if the request asks for less than a whole
///         search of one recording.
[[nodiscard]] std::optional<WorkflowOutcome> RunBesideLawError(WorkflowRequest request);

}  // namespace armcmc::gap
