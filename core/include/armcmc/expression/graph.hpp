#pragma once

#include <array>
#include <map>
#include <tuple>
#include <vector>

#include "armcmc/expression/operation.hpp"
#include "armcmc/expression/scope.hpp"
#include "armcmc/expression/syntax.hpp"

namespace armcmc::expression {

/// One value of a plant. Equal computations share a node.
struct GraphNode {
  Op op = Op::kNumber;
  /// If a function with memory has a third argument, its first one is held between samples.
  std::array<int, kMaxArguments> argument{-1, -1, -1};
  double value = 0.0;                       ///< Value of a number.
  SymbolKind kind = SymbolKind::kConstant;  ///< Kind of a symbol: signal, time, parameter or state.
  int index = -1;                           ///< Index of a symbol among those of its kind.
  bool sampled = false;                     ///< Depends on a parameter or a state.
  bool varies = false;                      ///< Depends on a signal, a state or time: differs from sample to sample.
  bool memory = false;                      ///< Depends on earlier samples.
};

/// The expressions of a plant as one graph without repetition: what is a number is folded, what is computed twice is
/// shared. Nodes follow their arguments.
///
/// Nodes are never removed, so that numbers of nodes stay valid. Allocates; for set-up, never for the step path, for
/// which FeatureProgram and Tape are compiled from it.
class Graph {
 public:
  /// Node of a number.
  [[nodiscard]] int Number(double value);
  /// Node of a symbol.
  /// @param kind   What it stands for.
  /// @param index  Among the symbols of its kind.
  [[nodiscard]] int Symbol(SymbolKind kind, int index);
  /// A node for op(a, b, c), or a simpler one of the same value.
  [[nodiscard]] int Make(Op op, int a = -1, int b = -1, int c = -1);

  /// Nodes of a text; `let` are the nodes of the scope's named expressions, by their index.
  /// @pre Check(syntax, scope) passes.
  [[nodiscard]] int Lower(const Syntax& syntax, const Scope& scope, const std::vector<int>& let);

  /// d node / d by, exact between the jumps and kinks of the expression; 0 at them.
  /// @param node  What is differentiated.
  /// @param by    A symbol. Memory functions of it are differentiated along with their argument; where the time
  ///              constant itself depends on it, the language cannot express the derivative.
  /// @return -1 in that case.
  [[nodiscard]] int Differentiate(int node, int by);

  /// The node with symbols replaced, memory functions included: symbol -> node.
  [[nodiscard]] int Substitute(int node, const std::map<int, int>& by);

  /// A node. @throws std::out_of_range.
  [[nodiscard]] const GraphNode& at(int node) const { return nodes_.at(static_cast<std::size_t>(node)); }
  /// Number of nodes; their numbers are 0 to size() - 1.
  [[nodiscard]] int size() const noexcept { return static_cast<int>(nodes_.size()); }
  /// Whether a node is a literal number.
  [[nodiscard]] bool IsNumber(int node) const { return at(node).op == Op::kNumber; }
  [[nodiscard]] bool IsNumber(int node, double value) const { return IsNumber(node) && at(node).value == value; }
  /// Whether `node` is computed from `other`, directly or not.
  [[nodiscard]] bool DependsOn(int node, int other) const;

 private:
  using Key = std::tuple<Op, std::array<int, kMaxArguments>, std::uint64_t, SymbolKind, int>;

  [[nodiscard]] int Insert(GraphNode node);
  [[nodiscard]] int Simplified(Op op, int a, int b, int c);
  [[nodiscard]] int SimplifiedArithmetic(Op op, int a, int b);
  [[nodiscard]] int Derivative(int node, int by, std::map<int, int>* known);

  std::vector<GraphNode> nodes_;
  std::map<Key, int> known_;
};

}  // namespace armcmc::expression
