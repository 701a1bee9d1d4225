#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "form_code.hpp"

namespace armcmc::gap {

/// A state of a form, as nodes of a graph.
struct FormState {
  int start = -1;  ///< Before the first sample; read there.
  int rate = -1;   ///< Its derivative; -1: `next` is given,
  int next = -1;   ///< the value one sample later.
};

/// Expressions of a form together with the states that they read.
///
/// A state with a rate moves from one sample to the next as z' = rate with all else held: exact where the rate is
/// linear in it. Over a recording the rate must be.
class FormProgram {
 public:
  static constexpr std::size_t kMostStates = 8;

  /// States may read those before them. Those that no output needs are left out.
  /// @throws std::invalid_argument where code is not available or a rate has no derivative.
  FormProgram(expression::Graph* graph, const std::vector<FormState>& states, const std::vector<int>& outputs);

  /// The outputs over a recording. @param law  What a filter acts on; else null.
  [[nodiscard]] std::vector<Vector> Over(const Signals& signals, const Vector* law, const double* values) const;
  /// The first output in a simulated motion.
  [[nodiscard]] double At(const Motion& motion, const double* values, const double* memory) const;
  /// Moves the states by one sample.
  void Remember(const Motion& motion, const double* values, double* memory) const;

  [[nodiscard]] int num_states() const { return static_cast<int>(states_.size()); }
  [[nodiscard]] bool has_states() const;
  /// Whether every rate is linear in its state, as Over() needs.
  [[nodiscard]] bool is_linear() const;

 private:
  struct State {
    bool needed = false, linear = true, jumps = false;
    FormCode start;
    FormCode rate;  ///< Outputs: the rate and its slope by the state. Of a state that jumps: its next value.
    FormCode rest;  ///< Outputs: the slope, and the rate at zero.
  };
  /// Kept from one call to the next: it depends on no coordinate. Threads may share it.
  class Retreat {
   public:
    Vector Of(const Signals& signals);

   private:
    std::mutex mutex_;
    double spread_ = 0.0;
    Vector velocity_, last_;
  };

  std::vector<State> states_;
  FormCode outputs_;
  bool reads_retreat_ = false;
  std::shared_ptr<Retreat> retreat_ = std::make_shared<Retreat>();
};

}  // namespace armcmc::gap
