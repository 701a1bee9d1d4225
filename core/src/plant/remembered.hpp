#pragma once

#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "armcmc/expression/graph.hpp"
#include "armcmc/plant/states.hpp"

namespace armcmc {

/// Functions with memory of a plant's laws and rates, brought into forms that a tape can run.
///
/// - `lowpass(e, tau)`, `integral(e)` of what a parameter or a state changes: a further state, exact between samples.
/// - `delay(e, tau)`, `previous(e)` of such an e: e of delayed signals, f(delay(u, tau), theta).
/// - `delay(u, tau)` of signals alone by a tau that is sampled: u is kept, and every candidate looks its own sample up.
/// - Any of signals alone: in a law a feature; in a rate an input that is linear between samples.
class Remembered {
 public:
  /// @param num_states  Of the plant; those that are added come behind them.
  Remembered(expression::Graph* graph, int num_states) : graph_(*graph), num_states_(num_states) {}

  /// The law, or the rate, without functions with memory that a tape cannot run.
  /// @throws std::invalid_argument, std::length_error saying what is not possible.
  [[nodiscard]] int InLaw(int node) { return Visit(node, false); }
  [[nodiscard]] int InRate(int node) { return Visit(node, true); }

  /// States that were added, in an order in which each needs those before it alone.
  [[nodiscard]] const std::vector<RememberedState>& states() const noexcept { return states_; }
  /// Rate of an added state, for others that read it between samples.
  [[nodiscard]] int RateOf(const RememberedState& state);
  /// Starts of the added states. @param starts  Of the plant's.
  [[nodiscard]] std::vector<int> Starts(std::vector<int> starts);

  /// Functions with memory that rates read as inputs: input i is the signal PlantPoint::kFirstRemembered + i.
  [[nodiscard]] const std::vector<int>& inputs() const noexcept { return inputs_; }
  /// What is kept to be looked up: the newest sample of line i stands at the signal PlantPoint::kFirstPosition + i.
  [[nodiscard]] const std::vector<int>& lines() const noexcept { return lines_; }

  /// True where the node makes states of functions with memory.
  [[nodiscard]] static bool MakesStates(const expression::Graph& graph, int node);

 private:
  int Visit(int node, bool in_rate);
  int Shifted(int node, expression::Op op, int tau, bool in_rate);
  int ShiftedAnew(int node, expression::Op op, int tau, bool in_rate);
  int AddState(int argument, int tau);
  int Input(int node);
  int PastOf(int node, int tau);

  expression::Graph& graph_;
  int num_states_;
  std::map<std::pair<int, bool>, int> known_;
  std::map<std::tuple<int, expression::Op, int, bool>, int> shifted_;
  std::vector<RememberedState> states_;
  std::vector<int> inputs_, lines_;
};

}  // namespace armcmc
