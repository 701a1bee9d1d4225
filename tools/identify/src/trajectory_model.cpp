#include "armcmc/identify/trajectory_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

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
  for (std::size_t s = 0; s < num_signals_; ++s)
    if (law_.Reads(s)) law_reads_.push_back(s);
  num_past_ = past.size();
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

/// States of candidates from sample to sample, and what their rates remember.
class TrajectoryModel::Walk {
 public:
  /// @param fixed   [input] Those that vary by candidate.
  /// @param offset  [state] Added to the starts; may be null.
  Walk(const TrajectoryModel& model, const std::vector<Lanes>& fixed, const std::vector<Lanes>* offset)
      : model_(model),
        offset_(offset),
        input_(fixed),
        before_(model.num_past_),
        after_(model.num_past_),
        origin_(model.num_states_),
        rate_(model.num_states_),
        sum_(model.num_states_),
        rate_run_(model.rate_.Begin(fixed.data(), model.series_->dt)),
        past_run_(model.past_.Begin(fixed.data(), model.series_->dt)),
        start_run_(model.start_.Begin(fixed.data(), model.series_->dt)) {}

  /// To the row, which is the first of a run or follows the last one.
  void To(std::size_t row, bool begins) {
    if (begins) past_run_.Clear();
    SetSignals(row);
    const double* const t = &model_.series_->t[row];
    if (model_.num_past_ > 0) model_.past_.Evaluate(1, input_.data(), 1, t, &past_run_, after_.data());
    if (begins) {
      model_.start_.Evaluate(1, input_.data(), 1, t, &start_run_, State());
      for (std::size_t s = 0; offset_ != nullptr && s < model_.num_states_; ++s)
        for (std::size_t l = 0; l < kLanes; ++l) State()[s][l] += (*offset_)[s][l];
    } else {
      Advance(row - 1);
    }
    std::swap(before_, after_);
  }
  [[nodiscard]] Lanes* State() { return input_.data() + model_.first_state_; }

 private:
  void SetSignals(std::size_t row) {
    for (std::size_t s = 0; s < model_.num_signals_; ++s) input_[s].fill(model_.series_->signals[s][row]);
  }

  /// Classical Runge-Kutta from `row` to the next.
  void Advance(std::size_t row) {
    constexpr std::array<double, 4> kPart{0.0, 0.5, 0.5, 1.0}, kWeight{1.0, 2.0, 2.0, 1.0};
    const std::size_t num_states = model_.num_states_;
    Lanes* const state = State();
    Lanes* const past = input_.data() + (model_.num_inputs_ - model_.num_past_);
    const double h = model_.series_->dt / model_.substeps_;
    for (int i = 0; i < model_.substeps_; ++i) {
      std::copy_n(state, num_states, origin_.begin());
      std::fill(sum_.begin(), sum_.end(), Lanes{});
      for (std::size_t stage = 0; stage < kPart.size(); ++stage) {
        const double part = (i + kPart[stage]) / model_.substeps_;
        for (std::size_t s = 0; s < model_.num_signals_; ++s) {
          const double* const value = &model_.series_->signals[s][row];
          input_[s].fill(value[0] + part * (value[1] - value[0]));
        }
        for (std::size_t p = 0; p < model_.num_past_; ++p)
          for (std::size_t l = 0; l < kLanes; ++l) past[p][l] = before_[p][l] + part * (after_[p][l] - before_[p][l]);
        if (stage > 0)
          for (std::size_t s = 0; s < num_states; ++s)
            for (std::size_t l = 0; l < kLanes; ++l) state[s][l] = origin_[s][l] + kPart[stage] * h * rate_[s][l];
        const double t = model_.series_->t[row] + part * model_.series_->dt;
        model_.rate_.Evaluate(1, input_.data(), 1, &t, &rate_run_, rate_.data());
        for (std::size_t s = 0; s < num_states; ++s)
          for (std::size_t l = 0; l < kLanes; ++l) sum_[s][l] += kWeight[stage] * rate_[s][l];
      }
      for (std::size_t s = 0; s < num_states; ++s)
        for (std::size_t l = 0; l < kLanes; ++l) state[s][l] = origin_[s][l] + h / 6.0 * sum_[s][l];
    }
  }

  const TrajectoryModel& model_;
  const std::vector<Lanes>* const offset_;
  std::vector<Lanes> input_, before_, after_, origin_, rate_, sum_;
  LaneRun rate_run_, past_run_, start_run_;
};

template <class See>
void TrajectoryModel::Run(const Eigen::MatrixXd& thetas, Eigen::Index first, Eigen::Index count,
                          const std::vector<Lanes>* offset, const std::vector<Eigen::Index>* only, See see) const {
  std::vector<Lanes> fixed(num_inputs_);
  for (std::size_t d = 0; d < parameters_.size(); ++d)
    for (std::size_t l = 0; l < kLanes; ++l)  // what is not asked for repeats the last
      fixed[num_signals_ + d][l] =
          thetas(static_cast<Eigen::Index>(d), first + std::min(static_cast<Eigen::Index>(l), count - 1));
  const bool sequential = num_states_ > 0 || law_.has_memory();
  if (sequential) only = nullptr;
  Walk walk(*this, fixed, offset);
  LaneRun law_run = law_.Begin(fixed.data(), series_->dt);
  const std::size_t first_column = first_state_ + num_states_;
  std::vector<Lanes> input(num_inputs_ * kTile);
  std::array<Lanes, kTile> law{};
  std::array<std::size_t, kTile> row{};
  std::array<double, kTile> t{};
  const std::size_t size = only != nullptr ? only->size() : num_rows();
  std::size_t run = 0;
  for (std::size_t k = 0; k < size;) {
    const bool begins = run < series_->runs.size() && series_->runs[run] == k;
    std::size_t end = std::min(k + kTile, size);
    if (sequential && begins) {
      law_run.Clear();
      ++run;
    }
    if (sequential && run < series_->runs.size()) end = std::min(end, series_->runs[run]);
    const std::size_t samples = end - k;
    for (std::size_t r = 0; r < samples; ++r) {
      const std::size_t n = only != nullptr ? static_cast<std::size_t>((*only)[k + r]) : k + r;
      row[r] = n;
      t[r] = series_->t[n];
      for (const std::size_t s : law_reads_) input[s * kTile + r].fill(series_->signals[s][n]);
      for (std::size_t c = 0; c < columns_.size(); ++c) input[(first_column + c) * kTile + r].fill(columns_[c][n]);
      if (num_states_ == 0) continue;
      walk.To(n, begins && r == 0);
      for (std::size_t s = 0; s < num_states_; ++s) input[(first_state_ + s) * kTile + r] = walk.State()[s];
    }
    law_.Evaluate(samples, input.data(), kTile, t.data(), &law_run, law.data());
    for (std::size_t r = 0; r < samples; ++r)
      see(static_cast<Eigen::Index>(row[r]), law[r],
          [&](std::size_t s) -> const Lanes& { return input[(first_state_ + s) * kTile + r]; });
    k = end;
  }
}

void TrajectoryModel::Predict(const Eigen::MatrixXd& thetas, Eigen::MatrixXd* predictions,
                              const std::vector<Eigen::Index>* only) const {
  constexpr auto kWidth = static_cast<Eigen::Index>(kLanes);
  predictions->resize(static_cast<Eigen::Index>(num_rows()), thetas.cols());
  if (only != nullptr) predictions->setZero();
  for (Eigen::Index first = 0; first < thetas.cols(); first += kWidth) {
    const Eigen::Index count = std::min(kWidth, thetas.cols() - first);
    Run(thetas, first, count, nullptr, only, [&](Eigen::Index n, const Lanes& law, const auto&) {
      for (Eigen::Index c = 0; c < count; ++c) (*predictions)(n, first + c) = law[static_cast<std::size_t>(c)];
    });
  }
  for (Eigen::Index c = 0; c < thetas.cols(); ++c)
    if (!predictions->col(c).allFinite()) (*predictions)(0, c) = std::numeric_limits<double>::quiet_NaN();
}

bool TrajectoryModel::PredictOne(const Eigen::VectorXd& theta, Eigen::VectorXd* prediction) const {
  Eigen::MatrixXd predictions;
  Predict(theta, &predictions);
  *prediction = predictions.col(0);
  return std::isfinite((*prediction)[0]);
}

Eigen::MatrixXd TrajectoryModel::States(const Eigen::VectorXd& theta) const {
  Eigen::MatrixXd states(static_cast<Eigen::Index>(num_rows()), static_cast<Eigen::Index>(num_states_));
  Run(theta, 0, 1, nullptr, nullptr, [&](Eigen::Index n, const Lanes&, const auto& state) {
    for (std::size_t s = 0; s < num_states_; ++s) states(n, static_cast<Eigen::Index>(s)) = state(s)[0];
  });
  return states;
}

Eigen::Index TrajectoryModel::RowsToForget(const Eigen::VectorXd& theta, double share) const {
  // Lane 0 as it is, lane s + 1 with another start of state s.
  std::vector<Lanes> offset(num_states_, Lanes{});
  const Eigen::MatrixXd states = num_states_ > 0 ? States(theta) : Eigen::MatrixXd();
  bool any = false;
  for (std::size_t s = 0; s < num_states_; ++s) {
    if (!plant_->graph().IsNumber(plant_->states()[s].start)) continue;
    const double rms =
        std::sqrt(states.col(static_cast<Eigen::Index>(s)).squaredNorm() / static_cast<double>(num_rows()));
    offset[s][s + 1] = rms;
    any = any || rms > 0.0;
  }
  if (!any) return 0;
  const std::size_t length = series_->runs.size() > 1 ? series_->runs[1] : num_rows();
  std::vector<double> change(length, 0.0);
  Run(theta, 0, 1, &offset, nullptr, [&](Eigen::Index n, const Lanes& law, const auto&) {
    if (static_cast<std::size_t>(n) >= length) return;
    for (std::size_t s = 0; s < num_states_; ++s)
      change[static_cast<std::size_t>(n)] =
          std::max(change[static_cast<std::size_t>(n)], std::fabs(law[s + 1] - law[0]));
  });
  const double most = *std::max_element(change.begin(), change.end());
  std::size_t rows = length;
  while (rows > 0 && !(change[rows - 1] > share * most)) --rows;
  return static_cast<Eigen::Index>(rows);
}

bool TrajectoryModel::Linearise(const Eigen::VectorXd& theta, Eigen::VectorXd* prediction, Eigen::MatrixXd* jacobian,
                                const std::vector<Eigen::Index>* only) const {
  constexpr double kStep = 1e-5;
  const Eigen::VectorXd spread = Spread(), lower = Lower(), upper = Upper();
  const Eigen::Index size = num_parameters();
  // The point itself, then a step up and one down along every parameter.
  Eigen::MatrixXd thetas = theta.replicate(1, 1 + 2 * size);
  for (Eigen::Index d = 0; d < size; ++d) {
    thetas(d, 1 + d) = std::min(theta[d] + kStep * spread[d], upper[d]);
    thetas(d, 1 + size + d) = std::max(theta[d] - kStep * spread[d], lower[d]);
  }
  Eigen::MatrixXd predictions;
  Predict(thetas, &predictions, only);
  if (!predictions.row(0).allFinite()) return false;
  *prediction = predictions.col(0);
  jacobian->resize(prediction->size(), size);
  for (Eigen::Index d = 0; d < size; ++d) {
    const double width = thetas(d, 1 + d) - thetas(d, 1 + size + d);
    if (!(width > 0.0)) return false;
    jacobian->col(d) = (predictions.col(1 + d) - predictions.col(1 + size + d)) / width;
  }
  return true;
}

}  // namespace armcmc::identify
