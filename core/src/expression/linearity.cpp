#include "armcmc/expression/linearity.hpp"

#include <algorithm>
#include <map>

namespace armcmc::expression {
namespace {

constexpr int kCurved = 2;

/// Degree of nodes as polynomials in some symbols; kCurved is any that is not linear.
class Degrees {
 public:
  Degrees(const Graph& graph, const std::vector<int>& symbols) : graph_(graph), symbols_(symbols) {}

  int Of(int node) {
    const auto at = known_.find(node);
    if (at != known_.end()) return at->second;
    const int degree = Compute(node);
    known_.emplace(node, degree);
    return degree;
  }

 private:
  int Compute(int node) {
    const GraphNode& n = graph_.at(node);
    if (std::find(symbols_.begin(), symbols_.end(), node) != symbols_.end()) return 1;
    if (n.op == Op::kSymbol) return n.kind == SymbolKind::kState ? kCurved : 0;
    std::array<int, kMaxArguments> degree{};
    for (std::size_t i = 0; i < kMaxArguments; ++i)
      if (n.argument[i] >= 0) degree[i] = Of(n.argument[i]);
    const int most = *std::max_element(degree.begin(), degree.end());
    switch (n.op) {
      case Op::kAdd:
      case Op::kSubtract:
      case Op::kNegate: return most;
      case Op::kMultiply: return std::min(degree[0] + degree[1], kCurved);
      case Op::kDivide: return degree[1] == 0 ? degree[0] : kCurved;
      case Op::kIf: return degree[0] == 0 ? most : kCurved;
      default: return most == 0 ? 0 : kCurved;
    }
  }

  const Graph& graph_;
  const std::vector<int>& symbols_;
  std::map<int, int> known_;
};

}  // namespace

bool IsLinear(const Graph& graph, int node, const std::vector<int>& symbols) {
  return Degrees(graph, symbols).Of(node) <= 1;
}

LinearPart FindLinearPart(Graph* graph, const std::vector<int>& laws, int num_parameters) {
  for (int curved = -1; curved < num_parameters; ++curved) {
    LinearPart part{.curved = curved};
    std::vector<int> symbols;
    for (int d = 0; d < num_parameters; ++d) {
      if (d == curved) continue;
      part.linear[static_cast<std::size_t>(part.num_linear++)] = d;
      symbols.push_back(graph->Symbol(SymbolKind::kParameter, d));
    }
    if (std::all_of(laws.begin(), laws.end(), [&](int law) { return IsLinear(*graph, law, symbols); })) return part;
  }
  return {};
}

}  // namespace armcmc::expression
