#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "armcmc/expression/graph.hpp"
#include "armcmc/expression/operation.hpp"

namespace armcmc::identify {

/// Candidates that are evaluated at once.
inline constexpr std::size_t kLanes = 16;
/// One value of every candidate.
using Lanes = std::array<double, kLanes>;

/// What functions with memory carry from sample to sample.
struct LaneMemory {
  struct Slot {
    Lanes state{};   ///< Of a low pass or an integral.
    Lanes before{};  ///< The argument one sample earlier.
  };
  bool empty = true;  ///< No sample yet.
  std::vector<Slot> slot;
  std::vector<std::vector<Lanes>> line;  ///< [delay][sample of the run]

  /// The next sample is the first of a run.
  void Clear();
};

/// Expressions of a graph for several candidates side by side, sample by sample in the order of time.
///
/// The same values as expression::FeatureProgram has for each of them; delays reach back to the beginning of the run.
/// One walk through the operations serves all lanes, so that walking costs little.
class LaneProgram {
 public:
  LaneProgram() = default;
  /// @param shared  [signal] 1: the same in all lanes.
  LaneProgram(const expression::Graph& graph, const std::vector<int>& outputs, const std::vector<std::uint8_t>& shared);

  /// out[i] = output i at this sample.
  /// @param input   Signals.
  /// @param t, dt   s, plant time, and time since the sample before.
  /// @param memory  Of Memory(); may be null without functions with memory.
  void Evaluate(const Lanes* input, double t, double dt, LaneMemory* memory, Lanes* out) const;

  [[nodiscard]] LaneMemory Memory() const;
  [[nodiscard]] bool has_memory() const noexcept { return num_memories_ > 0; }
  [[nodiscard]] std::size_t size() const noexcept { return code_.size(); }

 private:
  struct Instruction {
    expression::Op op = expression::Op::kNumber;
    std::array<int, expression::kMaxArguments> argument{};
    double value = 0.0;
    bool time = false;
    bool shared = false;  ///< The same in all lanes.
    int index = 0;        ///< Of a signal; of a memory.
    int line = -1;        ///< Of a delay.
  };
  void Remember(const Instruction& instruction, const Lanes& e, const Lanes& tau, double dt, LaneMemory* memory,
                Lanes* out) const;

  std::vector<Instruction> code_;
  std::vector<int> outputs_;
  int num_memories_ = 0, num_delays_ = 0;
};

}  // namespace armcmc::identify
