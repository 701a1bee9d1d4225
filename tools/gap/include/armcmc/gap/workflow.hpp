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
  Recording data;                      ///< To diagnose; without `heldout`, its end is kept sealed.
  std::optional<Recording> heldout;    ///< To show the gap on.
  std::optional<Recording> earlier;    ///< What its verdict left open is judged by both recordings, see Join.
  Step until = Step::kShow;
  DiagnoseOptions diagnose;
  /// Called with the name of each step as it begins, and the share of the work before it.
  std::function<void(const std::string&, double)> progress;
};

/// What a run hands to the writers of files.
struct WorkflowOutcome {
  Result result;
  std::optional<EstimatorSettings> augmented;  ///< When an effect is to be added.
};

/// Simulate and compare, find where, name, add, show. Deterministic for a seed.
/// @throws std::invalid_argument when the data cannot say anything; says why.
[[nodiscard]] WorkflowOutcome RunWorkflow(const WorkflowRequest& request);

}  // namespace armcmc::gap
