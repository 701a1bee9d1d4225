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

namespace {

/// Fills in `linear`: all parameters but the curved ones. @return whether the laws are linear in them.
bool IsLinearInOthers(Graph* graph, const std::vector<int>& laws, int num_parameters, LinearPart* part) {
  std::vector<int> symbols;
  for (int d = 0; d < num_parameters; ++d) {
    if (d == part->curved || d == part->second) continue;
    part->linear[static_cast<std::size_t>(part->num_linear++)] = d;
    symbols.push_back(graph->Symbol(SymbolKind::kParameter, d));
  }
  return std::all_of(laws.begin(), laws.end(), [&](int law) { return IsLinear(*graph, law, symbols); });
}

/// Fills in `needs`. @return whether no function needs both curved parameters, in any of the laws.
bool FindNeeds(Graph* graph, const std::vector<int>& laws, LinearPart* part) {
  const int curved = graph->Symbol(SymbolKind::kParameter, part->curved);
  const int second = graph->Symbol(SymbolKind::kParameter, part->second);
  std::map<int, int> without;
  for (int i = 0; i < part->num_linear; ++i)
    without[graph->Symbol(SymbolKind::kParameter, part->linear[static_cast<std::size_t>(i)])] = graph->Number(0.0);
  for (int i = 0; i <= part->num_linear; ++i) {
    unsigned needs = LinearPart::kNeither;
    for (const int law : laws) {
      const int f = i == 0 ? graph->Substitute(law, without)
                           : graph->Differentiate(law, graph->Symbol(SymbolKind::kParameter,
                                                                     part->linear[static_cast<std::size_t>(i - 1)]));
      if (f < 0) return false;
      if (graph->DependsOn(f, curved)) needs |= LinearPart::kCurved;
      if (graph->DependsOn(f, second)) needs |= LinearPart::kSecond;
    }
    if (needs == LinearPart::kBoth) return false;
    part->needs[static_cast<std::size_t>(i)] = static_cast<LinearPart::Need>(needs);
  }
  return true;
}

}  // namespace

LinearPart FindLinearPart(Graph* graph, const std::vector<int>& laws, int num_parameters) {
  for (int curved = -1; curved < num_parameters; ++curved) {
    LinearPart part{.curved = curved};
    if (IsLinearInOthers(graph, laws, num_parameters, &part)) return part;
  }
  for (int curved = 0; curved < num_parameters && num_parameters > 2; ++curved)
    for (int second = curved + 1; second < num_parameters; ++second) {
      LinearPart part{.curved = curved, .second = second};
      if (IsLinearInOthers(graph, laws, num_parameters, &part) && FindNeeds(graph, laws, &part)) return part;
    }
  return {};
}

}  // namespace armcmc::expression
