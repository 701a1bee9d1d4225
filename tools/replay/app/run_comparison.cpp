#include <iostream>
#include <string>

#include "armcmc/compare/report.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/progress.hpp"
#include "runs.hpp"
#include "session.hpp"

namespace armcmc::replay {
namespace {

std::string Label(const std::string& config, const std::string& model) {
  if (model.empty()) return config;
  return (config.empty() ? "" : config + ", ") + "model " + model;
}

/// Both runs read all packs of the recording; numbers of draws that a live run left belong to that run alone.
compare::RunTrace Trace(const Arguments& a, const Session& session, const std::string& label, double done) {
  const Estimator names(session.settings);
  SourceRequest request = RequestFor(a, session, names);
  request.repeat_draws = false;
  request.one_recursion = true;
  const auto source = OpenSource(request);
  support::Progress progress("compare");
  return compare::TraceRun(session.settings, source.get(), label,
                           [&](double share) { progress.Update(done + 0.5 * share); });
}

}  // namespace

int RunComparison(const Arguments& a) {
  const std::string other_config = a.compare.empty() ? a.config : a.compare;
  const std::string other_model = a.compare_model.empty() ? a.model : a.compare_model;
  const Session first = ReadSession(a.config, a.model, a.seed), second = ReadSession(other_config, other_model, a.seed);
  std::ofstream out = OpenOutput(a.out);
  const compare::RunTrace left = Trace(a, first, Label(a.config, a.model), 0.0);
  const compare::RunTrace right = Trace(a, second, Label(other_config, other_model), 0.5);
  if (left.summary.packs == 0 || right.summary.packs == 0) throw support::InputError(a.data + ": holds no usable pack");
  out << compare::ReportHtml(left, right, a.data);
  Close(&out, a.out);
  std::cout << compare::SummaryText(left, right) << "report: " << a.out << '\n';
  return support::kExitOk;
}

}  // namespace armcmc::replay
