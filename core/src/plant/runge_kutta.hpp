#pragma once

#include <map>
#include <optional>
#include <vector>

#include "armcmc/expression/graph.hpp"
#include "armcmc/plant/states.hpp"

namespace armcmc {

/// A step of the classical Runge-Kutta method as nodes: the states a step later, of the states before it, the length of
/// the step, and what the rates need of the signals at its beginning, middle and end.
///
/// The length is the constant 0, and what is given i at point p is the given number 1 + p inputs().size() + i.
class RungeKutta {
 public:
  /// @param rates  One node per state.
  RungeKutta(expression::Graph* graph, std::vector<int> rates);

  /// The largest subexpressions of the rates that depend on neither parameters nor states.
  [[nodiscard]] const std::vector<int>& inputs() const noexcept { return inputs_; }

  /// Stage after stage.
  [[nodiscard]] std::vector<int> Staged();
  /// Nodes of Staged() in an order in which slow operations of one state overlap with those of the others.
  [[nodiscard]] const std::vector<int>& stages() const noexcept { return stages_; }

  /// Of rates that are linear in states and inputs: all stages in one, whose coefficients no sample changes. Empty
  /// where they are not, or where that would be too many coefficients.
  [[nodiscard]] std::vector<int> Linear();

  /// Takes functions with memory among the states to what they are at the end of the step, and leaves out the stages
  /// that nobody needs then.
  void MakeExact(const std::vector<RememberedState>& remembered, std::vector<int>* results);

 private:
  /// constant + sum of coefficient x symbol; neither constant nor coefficients change from sample to sample.
  struct Form {
    std::map<int, int> coefficient;  ///< Symbol -> node.
    int constant;
  };

  int Plus(int a, int b) { return graph_.Make(expression::Op::kAdd, a, b); }
  int Times(int a, int b) { return graph_.Make(expression::Op::kMultiply, a, b); }
  [[nodiscard]] int Given(int point, std::size_t input);
  /// A node that reads states and inputs, at a point of the step.
  [[nodiscard]] int At(int node, const std::vector<int>& states, int point);
  [[nodiscard]] std::vector<int> Rates(const std::vector<int>& states, int point);
  [[nodiscard]] std::vector<int> Moved(const std::vector<int>& rates, int h);

  /// Empty if it is not linear. Each node is treated once, however many use it.
  [[nodiscard]] std::optional<Form> FormOf(int node);
  [[nodiscard]] std::optional<Form> MakeForm(int node);
  [[nodiscard]] Form Plus(Form a, const Form& b);
  [[nodiscard]] Form Times(Form a, int factor);
  /// Of the rates, whose symbols are states and inputs, at a point of the step.
  [[nodiscard]] std::vector<Form> Rates(const std::vector<Form>& rates, const std::vector<Form>& states, int point);
  [[nodiscard]] std::vector<Form> Moved(const std::vector<Form>& states, const std::vector<Form>& rates, int h);
  [[nodiscard]] int NodeOf(const Form& form);

  expression::Graph& graph_;
  std::map<int, std::optional<Form>> forms_;
  std::vector<int> rates_, inputs_, states_, stages_;
  int h_, half_, third_, sixth_;
};

}  // namespace armcmc
