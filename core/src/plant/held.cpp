#include "armcmc/plant/held.hpp"

#include <array>

#include "armcmc/plant/between.hpp"

namespace armcmc {

using expression::GraphNode;
using expression::kMaxArguments;
using expression::Op;
using expression::SymbolKind;

namespace {

/// tau and half a sample.
int PlusHalfASample(expression::Graph* graph, int tau) {
  return graph->Make(Op::kAdd, tau,
                     graph->Make(Op::kMultiply, graph->Number(0.5), graph->Symbol(SymbolKind::kInterval, 0)));
}

}  // namespace

std::vector<bool> HeldSignals(const PlantDescription& plant) {
  std::vector<bool> held;
  for (const SignalDescription& signal : plant.signals) held.push_back(BetweenNamed(signal.between) == Between::kHeld);
  return held;
}

bool HeldNodes::Is(int node) {  // NOLINT(misc-no-recursion): as deep as the graph
  if (const auto known = known_.find(node); known != known_.end()) return known->second;
  const GraphNode& at = graph_.at(node);
  bool held = true;
  if (at.op == Op::kSymbol && at.varies) {
    held = at.kind == SymbolKind::kSignal && static_cast<std::size_t>(at.index) < held_.size() &&
           held_[static_cast<std::size_t>(at.index)];
  } else if (expression::InfoOf(at.op).memory) {
    held = (at.op == Op::kDelay || at.op == Op::kPrevious) && Is(at.argument[0]);
  } else {
    for (const int argument : at.argument) held = held && (argument < 0 || Is(argument));
  }
  return known_[node] = held;
}

int HeldForms::Visit(int node, bool between) {  // NOLINT(misc-no-recursion): see HeldNodes::Is
  const GraphNode at = graph_.at(node);
  if (!at.memory) return node;
  if (const auto known = known_.find({node, between}); known != known_.end()) return known->second;
  int made = -1;
  if (expression::InfoOf(at.op).memory) {
    made = Remembering(node, between);
  } else {
    std::array<int, kMaxArguments> argument{-1, -1, -1};
    for (std::size_t i = 0; i < kMaxArguments; ++i)
      if (at.argument[i] >= 0) argument[i] = Visit(at.argument[i], between);
    made = graph_.Make(at.op, argument[0], argument[1], argument[2]);
  }
  return known_[{node, between}] = made;
}

int HeldForms::Remembering(int node, bool between) {  // NOLINT(misc-no-recursion): see HeldNodes::Is
  const GraphNode at = graph_.at(node);
  if (at.argument[0] < 0) return node;  // elapsed()
  const bool held = held_.Is(at.argument[0]);
  const int tau = at.argument[1] < 0 ? -1 : Visit(at.argument[1], between);
  if (at.op == Op::kPrevious || !held) return graph_.Make(at.op, Visit(at.argument[0], between), tau);
  if (at.op != Op::kDelay) return graph_.Make(at.op, Visit(at.argument[0], true), tau, graph_.Number(1.0));
  const int of = Visit(at.argument[0], between);
  if (between) return graph_.Make(at.op, of, tau);
  if (graph_.at(tau).sampled) return graph_.Make(at.op, of, PlusHalfASample(&graph_, tau));
  return graph_.Make(at.op, of, tau, graph_.Number(1.0));
}

}  // namespace armcmc
