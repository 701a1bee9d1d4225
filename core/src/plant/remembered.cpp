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

/// Place of a node in a list that it joins where it is new.
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

/// The node some time ago: what it is made of some time ago.
int Remembered::Shifted(int node, Op op, int tau, bool in_rate) {  // NOLINT(misc-no-recursion): see Visit
  // A chain in which every link is used twice has more paths than anybody can wait for.
  const std::tuple<int, Op, int, bool> key{node, op, tau, in_rate};
  if (const auto known = shifted_.find(key); known != shifted_.end()) return known->second;
  const int made = ShiftedAnew(node, op, tau, in_rate);
  shifted_.emplace(key, made);
  return made;
}

int Remembered::ShiftedAnew(int node, Op op, int tau, bool in_rate) {  // NOLINT(misc-no-recursion): see Visit
  const GraphNode at = graph_.at(node);
  if (!at.varies) return node;
  if (!at.sampled) {
    if (op == Op::kDelay && graph_.at(tau).sampled) return PastOf(node, Visit(tau, in_rate));
    const int shifted = graph_.Make(op, node, tau);
    return in_rate ? Visit(shifted, true) : shifted;
  }
  const std::string name(expression::InfoOf(op).name);
  if (at.op == Op::kSymbol)
    throw std::invalid_argument("takes " + name + "() of a state: take it of the inputs in the state's rate instead");
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
  const int state = num_states_ + static_cast<int>(states_.size());
  if (state >= kMaxStates)
    throw std::length_error("needs more than " + std::to_string(kMaxStates) +
                            " states, of which each lowpass() and integral() of something sampled is one");
  states_.push_back({state, argument, tau});
  return graph_.Symbol(SymbolKind::kState, state);
}

int Remembered::Input(int node) {
  const int place = PlaceIn(&inputs_, node, PlantPoint::kMaxRemembered, "functions with memory in rates");
  return graph_.Symbol(SymbolKind::kSignal, PlantPoint::kFirstRemembered + place);
}

int Remembered::PastOf(int node, int tau) {
  const int place = PlaceIn(&lines_, node, expression::kMaxDelays, "signals that are looked up in the past");
  return graph_.Make(Op::kPast, graph_.Symbol(SymbolKind::kSignal, PlantPoint::kFirstPosition + place),
                     graph_.Make(Op::kDivide, tau, graph_.Symbol(SymbolKind::kInterval, 0)));
}

int Remembered::RateOf(const RememberedState& state) {
  if (state.tau < 0) return state.argument;
  const int symbol = graph_.Symbol(SymbolKind::kState, state.state);
  return graph_.Make(Op::kDivide, graph_.Make(Op::kSubtract, state.argument, symbol), state.tau);
}

std::vector<int> Remembered::Starts(std::vector<int> starts) {
  std::map<int, int> by;
  for (std::size_t i = 0; i < inputs_.size(); ++i)
    by.emplace(graph_.Symbol(SymbolKind::kSignal, PlantPoint::kFirstRemembered + static_cast<int>(i)), inputs_[i]);
  for (std::size_t s = 0; s < starts.size(); ++s)
    by.emplace(graph_.Symbol(SymbolKind::kState, static_cast<int>(s)), starts[s]);
  for (const RememberedState& state : states_) {
    starts.push_back(state.tau < 0 ? graph_.Number(0.0) : graph_.Substitute(state.argument, by));
    by.emplace(graph_.Symbol(SymbolKind::kState, state.state), starts.back());
  }
  return starts;
}

}  // namespace armcmc
