#include "armcmc/gap/equation.hpp"

#include <algorithm>
#include <stdexcept>

#include "armcmc/gap/experiment.hpp"

namespace armcmc::gap {

std::vector<double> SplitQuantiles(const Vector& series) {
  constexpr int kThresholds = 9;
  std::vector<double> sorted(series.data(), series.data() + series.size());
  std::sort(sorted.begin(), sorted.end());
  std::vector<double> at;
  for (int k = 1; k <= kThresholds; ++k)
    at.push_back(sorted[static_cast<std::size_t>(static_cast<double>(sorted.size() - 1) * k / (kThresholds + 1))]);
  return at;
}

std::vector<SplitVariable> Equation::SplitVariables(const Signals& s) const {
  std::vector<SplitVariable> variables;
  variables.push_back({s.active, "in " + passive_name(), "in " + active_name(), {0.5}});
  variables.push_back({s.at(Role::kVelocity), "while retracting", "while advancing", {0.0}});
  variables.push_back({s.at(Role::kPosition), "below x = %s", "above x = %s", SplitQuantiles(s.at(Role::kPosition))});
  const Vector speed = s.at(Role::kVelocity).cwiseAbs();
  variables.push_back({speed, "slower than %s", "faster than %s", SplitQuantiles(speed)});
  variables.push_back({s.t, "before t = %s s", "after t = %s s", SplitQuantiles(s.t)});
  return variables;
}

Experiment Equation::Separate(const Analysis& analysis, const std::vector<CandidatePtr>& candidates) const {
  Experiment experiment = SeparatingExperiment(*this, analysis, candidates);
  experiment.scenario_text = ScenarioText(*this, analysis, experiment);
  return experiment;
}

std::unique_ptr<Equation> MakeEquation(const std::string& model) {
  auto equations = MakeEquations(model);
  if (equations.size() != 1) throw std::invalid_argument(model + " has several equations");
  return std::move(equations.front());
}

std::vector<std::string> ColumnsOf(const std::string& model) {
  std::vector<std::string> columns;
  for (const auto& equation : MakeEquations(model))
    for (const std::string& column : equation->columns())
      if (std::find(columns.begin(), columns.end(), column) == columns.end()) columns.push_back(column);
  return columns;
}

}  // namespace armcmc::gap
