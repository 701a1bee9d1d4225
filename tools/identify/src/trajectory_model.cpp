#include "armcmc/identify/trajectory_model.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "armcmc/plant/held.hpp"

namespace armcmc::identify {
namespace {

using expression::Graph;
using expression::GraphNode;
using expression::Op;
using expression::SymbolKind;

bool IsLognormal(const ParameterDescription& p) { return p.prior == "lognormal"; }

}  // namespace

TrajectoryModel::TrajectoryModel(std::shared_ptr<const Plant> plant, std::shared_ptr<const Series> series)
    : plant_(std::move(plant)),
      series_(std::move(series)),
      num_signals_(plant_->description().signals.size()),
      num_states_(plant_->states().size()) {
  ChooseParameters();
  for (const SignalDescription& signal : plant_->description().signals)
    between_.push_back(BetweenNamed(signal.between));
  for (const StateDescription& state : plant_->description().states) substeps_ = std::max(substeps_, state.substeps);

  Graph graph = plant_->graph();
  const auto& modes = plant_->modes();
  const int zero = graph.Number(0.0);
  const auto constant = [&](double passive, double active) {
    return OfActingMode(&graph, zero, [&](std::size_t m) { return graph.Number(modes[m].passive ? passive : active); });
  };
  const int acts = constant(0.0, 1.0);
  const int target =
      OfActingMode(&graph, zero, [&](std::size_t m) { return modes[m].passive ? zero : modes[m].target; });
  std::vector<std::vector<double>> once;
  EvaluateOnce(graph, {target, acts}, &once);
  target_ = Eigen::Map<Eigen::VectorXd>(once[0].data(), static_cast<Eigen::Index>(once[0].size()));
  for (const double a : once[1]) active_.push_back(a != 0.0 ? 1 : 0);

  const int law = OfActingMode(
      &graph, zero, [&](std::size_t m) { return modes[m].passive ? zero : InMode(&graph, modes[m].law, m); });
  std::vector<int> rates, starts;
  for (const PlantState& state : plant_->states()) {
    const auto of = [&](int node) {
      return OfActingMode(&graph, InMode(&graph, node, modes.size() - 1),
                          [&](std::size_t m) { return InMode(&graph, node, m); });
    };
    rates.push_back(of(state.rate));
    starts.push_back(of(state.start));
  }
  const int with_columns = WithColumns(&graph, law);
  const std::vector<int> past = SplitMemory(&graph, &rates);
  std::vector<Varies> inputs(num_signals_, Varies::kBySample);
  inputs.insert(inputs.end(), parameters_.size(), Varies::kByLane);
  inputs.insert(inputs.end(), num_states_, Varies::kByBoth);
  inputs.insert(inputs.end(), columns_.size(), Varies::kBySample);
  inputs.insert(inputs.end(), past.size(), Varies::kByBoth);
  rate_ = LaneProgram(graph, rates, inputs);
  past_ = LaneProgram(graph, past, inputs);
  start_ = LaneProgram(graph, starts, inputs);
  law_ = LaneProgram(graph, {with_columns}, inputs);
  first_state_ = num_signals_ + parameters_.size();
  num_inputs_ = inputs.size();
  for (std::size_t s = 0; s < num_signals_; ++s) {
    if (law_.Reads(s)) law_reads_.push_back(s);
    if (rate_.Reads(s)) rate_reads_.push_back(s);
  }
  num_past_ = past.size();
  std::vector<bool> held_inputs = HeldSignals(plant_->description());
  held_inputs.resize(first_state_, true);  // parameters do not change either
  HeldNodes held(&graph, held_inputs);
  for (const int node : past) past_held_.push_back(held.Is(node));
}

void TrajectoryModel::ChooseParameters() {
  const auto& modes = plant_->modes();
  const auto& described = plant_->description().parameters;
  const auto active = std::count_if(modes.begin(), modes.end(), [](const PlantMode& m) { return !m.passive; });
  index_.assign(modes.size(), std::vector<int>(described.size(), -1));
  for (std::size_t d = 0; d < described.size(); ++d) {
    const bool copies = described[d].per_mode && active > 1;
    int last = -1;
    for (std::size_t m = 0; m < modes.size(); ++m) {
      if (!modes[m].passive && (last < 0 || copies)) {
        parameters_.push_back(described[d]);
        if (copies) parameters_.back().name += '_' + modes[m].name;
        last = static_cast<int>(parameters_.size()) - 1;
      }
      index_[m][d] = std::max(last, 0);
    }
  }
}

int TrajectoryModel::InMode(Graph* graph, int node, std::size_t mode) const {
  // Parameters and states become inputs behind the signals: one program serves every value of theirs.
  std::map<int, int> by;
  for (std::size_t d = 0; d < index_[mode].size(); ++d) {
    const auto sampled = static_cast<std::size_t>(index_[mode][d]);
    const int input = graph->Symbol(SymbolKind::kSignal, static_cast<int>(num_signals_ + sampled));
    by.emplace(plant_->NodeOf(SymbolKind::kParameter, static_cast<int>(d)),
               IsLognormal(parameters_[sampled]) ? graph->Make(Op::kExp, input) : input);
  }
  for (std::size_t s = 0; s < num_states_; ++s)
    by.emplace(plant_->NodeOf(SymbolKind::kState, static_cast<int>(s)),
               graph->Symbol(SymbolKind::kSignal, static_cast<int>(num_signals_ + parameters_.size() + s)));
  return graph->Substitute(node, by);
}

template <class NodeOfMode>
int TrajectoryModel::OfActingMode(Graph* graph, int otherwise, NodeOfMode node_of) const {
  const auto& modes = plant_->modes();
  int node = otherwise;
  for (std::size_t m = modes.size(); m-- > 0;)
    node = modes[m].when < 0 ? node_of(m) : graph->Make(Op::kIf, modes[m].when, node_of(m), node);
  return node;
}

int TrajectoryModel::WithColumns(Graph* graph, int node) {
  const auto moving = static_cast<int>(num_signals_ + parameters_.size() + num_states_);
  std::map<int, bool> moves;  // depends on a parameter or a state
  std::map<int, int> by;
  std::vector<int> fixed;
  const std::function<bool(int)> depends = [&](int n) {
    if (const auto known = moves.find(n); known != moves.end()) return known->second;
    const GraphNode at = graph->at(n);
    bool any = at.op == Op::kSymbol && at.kind == SymbolKind::kSignal && at.index >= static_cast<int>(num_signals_);
    for (const int argument : at.argument)
      if (argument >= 0 && depends(argument)) any = true;
    return moves[n] = any;
  };
  const std::function<void(int)> visit = [&](int n) {
    const GraphNode at = graph->at(n);
    if (at.op == Op::kNumber || by.count(n) > 0) return;
    if (!depends(n)) {
      by.emplace(n, graph->Symbol(SymbolKind::kSignal, moving + static_cast<int>(fixed.size())));
      fixed.push_back(n);
      return;
    }
    for (const int argument : at.argument)
      if (argument >= 0) visit(argument);
  };
  visit(node);
  EvaluateOnce(*graph, fixed, &columns_);
  return graph->Substitute(node, by);
}

std::vector<int> TrajectoryModel::SplitMemory(Graph* graph, std::vector<int>* nodes) const {
  const std::size_t first_state = num_signals_ + parameters_.size();
  const std::size_t first_past = first_state + num_states_ + columns_.size();
  std::map<int, int> by;
  std::vector<int> past;
  const std::function<void(int)> visit = [&](int n) {
    const GraphNode at = graph->at(n);
    if (by.count(n) > 0) return;
    if (expression::InfoOf(at.op).memory) {
      for (std::size_t s = 0; s < num_states_; ++s)
        if (graph->DependsOn(n, graph->Symbol(SymbolKind::kSignal, static_cast<int>(first_state + s))))
          throw PlantError("states", 0, "the rate of a state remembers a state: make what it remembers a state");
      by.emplace(n, graph->Symbol(SymbolKind::kSignal, static_cast<int>(first_past + past.size())));
      past.push_back(n);
      return;
    }
    for (const int argument : at.argument)
      if (argument >= 0) visit(argument);
  };
  for (const int node : *nodes) visit(node);
  for (int& node : *nodes) node = graph->Substitute(node, by);
  return past;
}

void TrajectoryModel::EvaluateOnce(const Graph& graph, const std::vector<int>& nodes,
                                   std::vector<std::vector<double>>* columns) const {
  columns->assign(nodes.size(), std::vector<double>(num_rows()));
  const LaneProgram program(graph, nodes, std::vector<Varies>(num_signals_, Varies::kBySample));
  std::vector<Lanes> input(num_signals_), out(nodes.size());
  LaneRun memory = program.Begin(input.data(), series_->dt);
  std::size_t run = 0;
  for (std::size_t n = 0; n < num_rows(); ++n) {
    if (run < series_->runs.size() && series_->runs[run] == n) {
      memory.Clear();
      ++run;
    }
    for (std::size_t s = 0; s < num_signals_; ++s) input[s].fill(series_->signals[s][n]);
    program.Evaluate(1, input.data(), 1, &series_->t[n], &memory, out.data());
    for (std::size_t c = 0; c < nodes.size(); ++c) (*columns)[c][n] = out[c][0];
  }
}

Eigen::VectorXd TrajectoryModel::Start() const {
  Eigen::VectorXd start(num_parameters());
  for (Eigen::Index d = 0; d < num_parameters(); ++d) {
    const ParameterDescription& p = parameters_[static_cast<std::size_t>(d)];
    start[d] = IsLognormal(p)         ? std::log(p.mean)
               : p.prior == "uniform" ? 0.5 * (*p.lower + *p.upper)
                                      : std::clamp(p.mean, *p.lower, *p.upper);
  }
  return start;
}

Eigen::VectorXd TrajectoryModel::Lower() const {
  Eigen::VectorXd bound(num_parameters());
  for (Eigen::Index d = 0; d < num_parameters(); ++d) {
    const ParameterDescription& p = parameters_[static_cast<std::size_t>(d)];
    constexpr double kReach = 8.0;  // a bound of 0 is beyond any
    bound[d] = IsLognormal(p) ? std::fmax(std::log(*p.lower), std::log(p.mean) - kReach * p.sd) : *p.lower;
  }
  return bound;
}

Eigen::VectorXd TrajectoryModel::Upper() const {
  Eigen::VectorXd bound(num_parameters());
  for (Eigen::Index d = 0; d < num_parameters(); ++d) {
    const ParameterDescription& p = parameters_[static_cast<std::size_t>(d)];
    bound[d] = IsLognormal(p) ? std::log(*p.upper) : *p.upper;
  }
  return bound;
}

Eigen::VectorXd TrajectoryModel::Spread() const {
  Eigen::VectorXd spread(num_parameters());
  for (Eigen::Index d = 0; d < num_parameters(); ++d) {
    const ParameterDescription& p = parameters_[static_cast<std::size_t>(d)];
    spread[d] = p.prior == "uniform" ? (*p.upper - *p.lower) / std::sqrt(12.0) : p.sd;
  }
  return spread;
}

double TrajectoryModel::Shown(Eigen::Index d, double sampled) const {
  return IsLognormal(parameters_[static_cast<std::size_t>(d)]) ? std::exp(sampled) : sampled;
}

}  // namespace armcmc::identify
