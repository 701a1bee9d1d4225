#pragma once

#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "armcmc/expression/graph.hpp"
#include "armcmc/plant/held.hpp"
#include "armcmc/plant/states.hpp"

namespace armcmc {

/// Functions with memory in the laws and rates of a plant, rewritten so that a tape can compute them.
///
/// - `lowpass(e, tau)`, `integral(e)` of what a parameter or a state changes: a further state, exact between samples.
/// - `delay(e, tau)`, `previous(e)` of such an e: e of delayed signals, f(delay(u, tau), theta); of a state: a further
///   state that is driven by them.
/// - `delay(u, tau)` of signals alone by a tau that is sampled: u is kept, and every candidate looks its own sample up.
/// - Any of signals alone: in a law a feature; in a rate an input that is linear or held between samples.
class Remembered {
 public:
  /// A state of the plant; those that are added come behind them.
  struct State {
    int rate = -1, start = -1;  ///< Nodes.
    bool measured = false;      ///< Each pack starts from a signal.
  };
  /// @param held  [signal] Whether it is held between samples.
  Remembered(expression::Graph* graph, std::vector<State> states, std::vector<bool> held)
      : graph_(*graph), of_plant_(std::move(states)), held_(graph, std::move(held)) {}

  /// The law, or the rate, without functions with memory that a tape cannot run.
  /// @throws std::invalid_argument, std::length_error with the reason.
  [[nodiscard]] int InLaw(int node) { return Visit(node, false); }
  [[nodiscard]] int InRate(int node) { return Visit(node, true); }

  [[nodiscard]] const std::vector<State>& of_plant() const noexcept { return of_plant_; }
  /// States that were added, in an order in which each needs those before it alone.
  [[nodiscard]] const std::vector<RememberedState>& states() const noexcept { return states_; }
  /// Rate of an added state, for others that read it between samples.
  [[nodiscard]] int RateOf(const RememberedState& state);
  /// Starts of all states.
  [[nodiscard]] std::vector<int> Starts();

  /// Functions with memory that rates read as inputs: input i is the signal PlantPoint::kFirstRemembered + i.
  [[nodiscard]] const std::vector<int>& inputs() const noexcept { return inputs_; }
  /// Whether it is held between samples: of an input; of a place in a line, behind kMaxRemembered of those. A rate that
  /// looks a held signal up from where the sample stands has its mean until the next one.
  [[nodiscard]] std::vector<bool> Held();
  /// What is kept to be looked up: the newest sample of line i stands at the signal PlantPoint::kFirstPosition + i.
  [[nodiscard]] const std::vector<int>& lines() const noexcept { return lines_; }

  /// True if the node creates states for functions with memory.
  [[nodiscard]] static bool MakesStates(const expression::Graph& graph, int node);

 private:
  int Visit(int node, bool in_rate);
  int Shifted(int node, expression::Op op, int tau, bool in_rate);
  int MakeShifted(int node, expression::Op op, int tau, bool in_rate);
  int AddState(int argument, int tau);
  int NewState(const RememberedState& state);
  int DelayedState(int state, int tau);
  /// @param held  Between samples, though it may not be made of what is.
  int Input(int node, bool held = false);
  int PastOf(int node, int tau);

  expression::Graph& graph_;
  std::vector<State> of_plant_;
  std::map<std::pair<int, bool>, int> known_;
  std::map<std::tuple<int, expression::Op, int, bool>, int> shifted_;
  std::vector<RememberedState> states_;
  std::vector<int> inputs_, lines_;
  std::vector<bool> inputs_held_;
  HeldNodes held_;
  std::map<std::pair<int, int>, int> late_;  ///< State and tau to the late one.
  std::vector<int> open_;                    ///< States whose late ones are being made.
};

}  // namespace armcmc
