#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "armcmc/gap/effect_form.hpp"
#include "row_program.hpp"

namespace armcmc::gap {

/// An expression of a form over a recording, together with the states that it reads.
///
/// A state with a rate moves from one sample to the next as z' = rate with all else held, which is exact: the rate must
/// be linear in it.
class FormProgram {
 public:
  /// States may read those before them. Those that the output does not need are left out.
  /// @throws std::invalid_argument where a function is not available or a rate is not linear.
  FormProgram(expression::Graph* graph, const std::vector<FormState>& states, int output);

  /// @param law     What a filter acts on; else null.
  /// @param values  Of the coordinates and, after them, the origin.
  [[nodiscard]] Vector Over(const Signals& signals, const Vector* law, const std::vector<double>& values) const;

 private:
  struct State {
    bool needed = false, jumps = false;
    RowProgram start;
    RowProgram move;  ///< Outputs: slope of the rate, and rate at zero. Of a state that jumps: its next value.
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
  RowProgram output_;
  std::shared_ptr<Retreat> retreat_ = std::make_shared<Retreat>();
};

/// An expression of a form as an acceleration in simulated motions, together with the states that it reads.
///
/// A state with a rate moves from one sample to the next by z' = rate + slope (z - z0), with all else held; it begins
/// at zero.
class ForceProgram {
 public:
  /// @throws std::invalid_argument where a function is not available or a rate has no derivative.
  ForceProgram(expression::Graph* graph, const std::vector<FormState>& states, int output);

  /// @param values  [coordinate] Those of each motion.
  [[nodiscard]] std::unique_ptr<MotionForce> Begin(const std::vector<identify::Lanes>& values, double dt) const;

 private:
  class Run;

  identify::LaneProgram force_, moves_;
  std::size_t num_states_;
};

}  // namespace armcmc::gap
