#pragma once

#include <vector>

#include "armcmc/expression/graph.hpp"
#include "armcmc/linear_part.hpp"

namespace armcmc::expression {

/// True where `node` is f_0 + sum_i symbol_i f_i with f that need none of the symbols, by the form of the expression:
/// false may mean only that the form does not show it. Always false for what depends on a state.
[[nodiscard]] bool IsLinear(const Graph& graph, int node, const std::vector<int>& symbols);

/// What all of some laws, which are nodes of the graph, are linear in: all of num_parameters parameters, else all but
/// the first that makes it so, else all but the first two of which no factor of another needs both, else nothing. Adds
/// nodes to the graph.
[[nodiscard]] LinearPart FindLinearPart(Graph* graph, const std::vector<int>& laws, int num_parameters);

}  // namespace armcmc::expression
