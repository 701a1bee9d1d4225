#pragma once

#include <vector>

#include "armcmc/expression/graph.hpp"

namespace armcmc::expression {

/// True where `node` is f_0 + sum_i symbol_i f_i with f that need none of the symbols, by the form of the expression:
/// false may only mean that this does not show. Of what depends on a state nothing is known.
[[nodiscard]] bool IsLinear(const Graph& graph, int node, const std::vector<int>& symbols);

}  // namespace armcmc::expression
