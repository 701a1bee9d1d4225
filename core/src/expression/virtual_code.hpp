#pragma once

#include <vector>

#include "armcmc/expression/compile.hpp"
#include "armcmc/expression/tape.hpp"

namespace armcmc::expression {

/// An instruction on registers of which there are as many as values.
struct Virtual {
  TapeOp op = TapeOp::kCopy;
  int to = -1;
  std::vector<int> registers;  ///< That it reads, in order.
  std::vector<int> scalars;    ///< Likewise.
  int number = 0;              ///< A small number that belongs to it: an exponent.
  bool once = false;
};

/// A tape before its registers are shared: every value has one of its own. The first values are the parameters and the
/// states.
struct VirtualCode {
  std::vector<Virtual> code;
  std::vector<bool> once;  ///< Of a value: known before the first sample.
  std::vector<int> results;

  [[nodiscard]] int num_values() const noexcept { return static_cast<int>(once.size()); }
};

/// Gives values that are alive at the same time registers of their own, and writes the code down.
/// @throws std::length_error naming the limit that is passed.
void Assemble(const VirtualCode& code, const TapeLayout& layout, Tape* tape);

/// Finds out whether the code has a form with a loop of its own.
void RecogniseShape(const VirtualCode& code, Tape* tape);

}  // namespace armcmc::expression
