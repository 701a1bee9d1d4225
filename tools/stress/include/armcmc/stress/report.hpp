#pragma once

#include <string>
#include <vector>

#include "armcmc/stress/options.hpp"
#include "armcmc/stress/phase.hpp"

namespace armcmc::stress {

/// The report as JSON: the estimator's keys for every phase, "faults" of all phases together, "verdict".
[[nodiscard]] std::string ReportJson(const StressOptions& options, const std::vector<PhaseResult>& phases);
/// The same as tables and a histogram in plain text.
[[nodiscard]] std::string ReportText(const StressOptions& options, const std::vector<PhaseResult>& phases);
/// The same as a page with a chart.
[[nodiscard]] std::string ReportHtml(const StressOptions& options, const std::vector<PhaseResult>& phases);
/// What one load came to, in a line.
[[nodiscard]] std::string PhaseLine(const PhaseResult& phase);

}  // namespace armcmc::stress
