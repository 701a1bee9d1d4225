#pragma once

#include <array>
#include <vector>

#include "armcmc/gap/form_input.hpp"
#include "armcmc/identify/lane_program.hpp"

namespace armcmc::gap {

/// What expressions over a recording read.
struct RowInputs {
  Eigen::Index rows = 0;
  double dt = 0.0;                                       ///< s
  std::array<const double*, kFirstValue> series{};       ///< [input][row]; null where no expression reads it.
  std::array<double, kNumFormInputs - kFirstValue> value{};  ///< Coordinates and origin.
};

/// Expressions of a graph over a whole recording: its rows stand side by side in the lanes of a program.
class RowProgram {
 public:
  RowProgram() = default;
  /// @throws std::invalid_argument for a function with memory other than previous() and a delay of the same time at all
  ///         samples.
  RowProgram(expression::Graph* graph, std::vector<int> outputs);

  /// The outputs; one that is the same at every sample has all its rows, too.
  [[nodiscard]] std::vector<Vector> Over(RowInputs inputs) const;
  /// The first row of the first output.
  [[nodiscard]] double AtFirst(RowInputs inputs) const;
  /// z[i] = the first output with z[i - 1] in place of state k, from `start` on. @pre No function with memory.
  [[nodiscard]] Vector Recursion(const RowInputs& inputs, int k, double start) const;

  [[nodiscard]] bool Reads(int input) const;

 private:
  /// previous(e) or delay(e, tau); the outputs of `of` are e and tau.
  struct Past;

  [[nodiscard]] identify::LaneRun Begin(const RowInputs& inputs) const;

  identify::LaneProgram program_;
  std::vector<int> reads_;  ///< Inputs that are read sample by sample.
  std::vector<Past> pasts_;
  std::size_t num_outputs_ = 0;
};

struct RowProgram::Past {
  expression::Op op = expression::Op::kPrevious;
  RowProgram of;
};

}  // namespace armcmc::gap
