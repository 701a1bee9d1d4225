#pragma once

#include <vector>

#include "armcmc/expression/graph.hpp"
#include "armcmc/expression/tape.hpp"

namespace armcmc::expression {

/// A tape, and the nodes of the graph that are its scalars.
struct CompiledTape {
  Tape tape;
  std::vector<int> scalars;  ///< Nodes that depend on no parameter and no state.
};

/// What a tape finds in its registers, and what it may have.
struct TapeLayout {
  int num_parameters = 0;
  int num_states = 0;
  int first_free = 0;        ///< Register from which on it may write: below are those of another tape.
  bool advances = false;     ///< The results are the states a step later, and take their registers.
  std::vector<int> first{};  ///< Nodes that are worked out before the results, in this order.
  int most_instructions = kMaxTapeInstructions;
  int most_scalars = kMaxTapeScalars;
};

/// Code for the values of `results`, whose parts that depend on neither parameter nor state become scalars.
///
/// Sums of products are gathered: what is linear in registers with scalar factors is one instruction.
///
/// @param scalars  Nodes that are scalars 0, 1, ... already: several tapes may share theirs.
/// @throws std::length_error naming the limit that is passed; std::invalid_argument where a function with memory has an
///         argument that depends on a parameter or a state.
[[nodiscard]] CompiledTape CompileTape(Graph* graph, const std::vector<int>& results, const TapeLayout& layout,
                                       std::vector<int> scalars = {});

}  // namespace armcmc::expression
