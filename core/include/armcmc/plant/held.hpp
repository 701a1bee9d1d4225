#pragma once

#include <map>
#include <utility>
#include <vector>

#include "armcmc/expression/graph.hpp"
#include "armcmc/plant/description.hpp"

namespace armcmc {

/// [signal] Those that are held between samples.
[[nodiscard]] std::vector<bool> HeldSignals(const PlantDescription& plant);

/// What of a plant's expressions is held between samples: what no signal, or one that is held, makes.
class HeldNodes {
 public:
  /// @param held  [signal]
  HeldNodes(const expression::Graph* graph, std::vector<bool> held) : graph_(*graph), held_(std::move(held)) {}

  /// A delay of what is held counts: what follows takes its mean between samples for what is held there.
  [[nodiscard]] bool Is(int node);

 private:
  const expression::Graph& graph_;
  std::vector<bool> held_;
  std::map<int, bool> known_;
};

/// Functions with memory of what is held between samples, in forms that are exact for it.
///
/// lowpass(e, tau), integral(e): marked, so that e counts as held (GraphNode). delay(e, tau), at t:
///   at a sample                   marked: what was held at t - tau
///   at a sample, tau is sampled   linear half a sample later, which is the same on average and moves with tau
///   for what integrates it        its mean over the interval that begins there: linear between samples
class HeldForms {
 public:
  HeldForms(expression::Graph* graph, std::vector<bool> held) : graph_(*graph), held_(graph, std::move(held)) {}

  /// The node for use at the samples, as laws are.
  [[nodiscard]] int AtSamples(int node) { return Visit(node, false); }
  /// For use in between, as rates are.
  [[nodiscard]] int BetweenSamples(int node) { return Visit(node, true); }

 private:
  int Visit(int node, bool between);
  int Remembering(int node, bool between);

  expression::Graph& graph_;
  HeldNodes held_;
  std::map<std::pair<int, bool>, int> known_;
};

}  // namespace armcmc
