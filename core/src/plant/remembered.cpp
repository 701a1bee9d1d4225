#include "plant/remembered.hpp"

#include <algorithm>
#include <stdexcept>

namespace armcmc {
namespace {

using expression::Graph;
using expression::GraphNode;
using expression::kMaxArguments;
using expression::Op;
using expression::SymbolKind;

/// Index of a node in a list, to which it is added if new.
int PlaceIn(std::vector<int>* list, int node, int most, const char* what) {
  const auto found = std::find(list->begin(), list->end(), node);
  const int place = static_cast<int>(found - list->begin());
  if (found == list->end()) {
    if (place == most) throw std::length_error("needs more than " + std::to_string(most) + ' ' + what);
    list->push_back(node);
  }
  return place;
}

}  // namespace

bool Remembered::MakesStates(const Graph& graph, int node) {
  std::vector<int> open{node};
  std::vector<bool> seen(static_cast<std::size_t>(graph.size()), false);
  while (!open.empty()) {
    const int n = open.back();
    open.pop_back();
    if (n < 0 || seen[static_cast<std::size_t>(n)]) continue;
    seen[static_cast<std::size_t>(n)] = true;
    const GraphNode& at = graph.at(n);
    if (!at.memory || !at.sampled) continue;
    if (at.op == Op::kLowpass || at.op == Op::kIntegral) return true;
    open.insert(open.end(), at.argument.begin(), at.argument.end());
  }
  return false;
}

int Remembered::Visit(int node, bool in_rate) {  // NOLINT(misc-no-recursion): as deep as the graph
  const GraphNode at = graph_.at(node);
  if (!at.memory || (!at.sampled && !in_rate)) return node;
  if (const auto known = known_.find({node, in_rate}); known != known_.end()) return known->second;
  int made = -1;
  if (!expression::InfoOf(at.op).memory) {
    std::array<int, kMaxArguments> argument{-1, -1, -1};
    for (std::size_t i = 0; i < kMaxArguments; ++i)
      if (at.argument[i] >= 0) argument[i] = Visit(at.argument[i], in_rate);
    made = graph_.Make(at.op, argument[0], argument[1], argument[2]);
  } else if (!at.sampled) {
    made = Input(node);
  } else if (at.op == Op::kLowpass || at.op == Op::kIntegral) {
    const int argument = Visit(at.argument[0], true);
    made = AddState(argument, at.op == Op::kLowpass ? Visit(at.argument[1], true) : -1);
  } else {
    made = Shifted(at.argument[0], at.op, at.argument[1], in_rate);
  }
  return known_[{node, in_rate}] = made;
}

/// The delayed node, computed from its delayed arguments.
int Remembered::Shifted(int node, Op op, int tau, bool in_rate) {  // NOLINT(misc-no-recursion): see Visit
  // A chain in which every link is used twice has an exponential number of paths.
  const std::tuple<int, Op, int, bool> key{node, op, tau, in_rate};
  if (const auto known = shifted_.find(key); known != shifted_.end()) return known->second;
  const int made = MakeShifted(node, op, tau, in_rate);
  shifted_.emplace(key, made);
  return made;
}

int Remembered::MakeShifted(int node, Op op, int tau, bool in_rate) {  // NOLINT(misc-no-recursion): see Visit
  const GraphNode at = graph_.at(node);
  if (!at.varies) return node;
  if (!at.sampled) {
    if (op == Op::kDelay && graph_.at(tau).sampled) return PastOf(node, Visit(tau, in_rate));
    const bool held = op == Op::kDelay && !in_rate && held_.Is(node);
    const int shifted = graph_.Make(op, node, tau, held ? graph_.Number(1.0) : -1);
    return in_rate ? Visit(shifted, true) : shifted;
  }
  const std::string name(expression::InfoOf(op).name);
  if (at.op == Op::kSymbol)
    return DelayedState(at.index, op == Op::kDelay ? Visit(tau, true) : graph_.Symbol(SymbolKind::kInterval, 0));
  if (at.op == Op::kLowpass && !graph_.at(at.argument[1]).varies)
    return AddState(Shifted(at.argument[0], op, tau, true), Visit(at.argument[1], true));
  if (at.op == Op::kDelay && op == Op::kDelay)
    return Shifted(at.argument[0], op, graph_.Make(Op::kAdd, at.argument[1], tau), in_rate);
  if (expression::InfoOf(at.op).memory)
    throw std::invalid_argument("takes " + name + "() of " + std::string(expression::InfoOf(at.op).name) +
                                "() of something that depends on a parameter: take it of the signals inside instead");
  std::array<int, kMaxArguments> argument{-1, -1, -1};
  for (std::size_t i = 0; i < kMaxArguments; ++i)
    if (at.argument[i] >= 0) argument[i] = Shifted(at.argument[i], op, tau, in_rate);
  return graph_.Make(at.op, argument[0], argument[1], argument[2]);
}

int Remembered::AddState(int argument, int tau) {
  const auto found = std::find_if(states_.begin(), states_.end(), [&](const RememberedState& state) {
    return state.argument == argument && state.tau == tau;
  });
  if (found != states_.end()) return graph_.Symbol(SymbolKind::kState, found->state);
  return NewState({.argument = argument, .tau = tau});
}

int Remembered::NewState(const RememberedState& state) {
  const int number = static_cast<int>(of_plant_.size() + states_.size());
  if (number >= kMaxStates)
    throw std::length_error("needs more than " + std::to_string(kMaxStates) +
                            " states, of which each lowpass() and integral() of something sampled is one, and each "
                            "state again that delay() or previous() asks for, with those that move it");
  states_.push_back(state);
  states_.back().state = number;
  return graph_.Symbol(SymbolKind::kState, number);
}

int Remembered::DelayedState(int state, int tau) {  // NOLINT(misc-no-recursion): as deep as there are states
  if (const auto known = late_.find({state, tau}); known != late_.end())
    return graph_.Symbol(SymbolKind::kState, known->second);
  const State& of = of_plant_[static_cast<std::size_t>(state)];
  if (of.measured)
    throw std::invalid_argument("takes delay() or previous() of a state that is measured: take it of its signal");
  if (std::find(open_.begin(), open_.end(), state) != open_.end())
    throw std::invalid_argument("takes delay() of a state that moves itself late, which takes more than states");
  const int symbol = NewState({.late = state});
  const std::size_t place = states_.size() - 1;
  late_.emplace(std::pair(state, tau), states_[place].state);
  open_.push_back(state);
  // It is constant until its first sample is tau ago; the interval in which it starts to change counts in part.
  const int interval = graph_.Symbol(SymbolKind::kInterval, 0);
  const int end = Input(graph_.Make(Op::kAdd, graph_.Make(Op::kElapsed), interval), true);
  const int share = graph_.Make(Op::kDivide, graph_.Make(Op::kSubtract, end, tau), interval);
  const int gate = graph_.Make(Op::kMin, graph_.Number(1.0), graph_.Make(Op::kMax, graph_.Number(0.0), share));
  const int rate = graph_.Make(Op::kMultiply, gate, Shifted(of.rate, Op::kDelay, tau, true));
  open_.pop_back();
  states_[place].rate = rate;
  return symbol;
}

int Remembered::Input(int node, bool held) {
  const int place = PlaceIn(&inputs_, node, PlantPoint::kMaxRemembered, "functions with memory in rates");
  if (inputs_held_.size() < inputs_.size()) inputs_held_.push_back(held || held_.Is(node));
  return graph_.Symbol(SymbolKind::kSignal, PlantPoint::kFirstRemembered + place);
}

std::vector<bool> Remembered::Held() {
  std::vector<bool> held = inputs_held_;
  held.resize(PlantPoint::kMaxRemembered, false);
  for (const int line : lines_) held.push_back(held_.Is(line));
  return held;
}

int Remembered::PastOf(int node, int tau) {
  const int place = PlaceIn(&lines_, node, expression::kMaxDelays, "signals that are looked up in the past");
  return graph_.Make(Op::kPast, graph_.Symbol(SymbolKind::kSignal, PlantPoint::kFirstPosition + place),
                     graph_.Make(Op::kDivide, tau, graph_.Symbol(SymbolKind::kInterval, 0)));
}

int Remembered::RateOf(const RememberedState& state) {
  if (state.late >= 0) return state.rate;
  if (state.tau < 0) return state.argument;
  const int symbol = graph_.Symbol(SymbolKind::kState, state.state);
  return graph_.Make(Op::kDivide, graph_.Make(Op::kSubtract, state.argument, symbol), state.tau);
}

std::vector<int> Remembered::Starts() {
  std::vector<int> starts;
  for (const State& state : of_plant_) starts.push_back(state.start);
  std::map<int, int> by;
  for (std::size_t i = 0; i < inputs_.size(); ++i)
    by.emplace(graph_.Symbol(SymbolKind::kSignal, PlantPoint::kFirstRemembered + static_cast<int>(i)), inputs_[i]);
  for (std::size_t s = 0; s < starts.size(); ++s)
    by.emplace(graph_.Symbol(SymbolKind::kState, static_cast<int>(s)), starts[s]);
  for (const RememberedState& state : states_) {
    starts.push_back(state.late >= 0 ? starts[static_cast<std::size_t>(state.late)]
                     : state.tau < 0 ? graph_.Number(0.0)
                                     : graph_.Substitute(state.argument, by));
    by.emplace(graph_.Symbol(SymbolKind::kState, state.state), starts.back());
  }
  return starts;
}

}  // namespace armcmc
