#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "armcmc/expression/graph.hpp"
#include "armcmc/expression/operation.hpp"
#include "armcmc/nonblocking.hpp"

namespace armcmc::expression {

inline constexpr int kMaxFeatureNodes = 512;
inline constexpr int kMaxMemories = 16;        ///< Functions with memory.
inline constexpr int kMaxDelays = 4;           ///< Delays among them.
inline constexpr int kMaxDelaySamples = 1024;  ///< The longest delay.

/// Past samples of the delayed quantities, as many as the longest delay needs.
struct PastSamples {
  int samples = 0;  ///< Samples written to each line; counts beyond its length.
  std::array<std::array<double, kMaxDelaySamples>, kMaxDelays> line{};
};

/// What functions with memory carry from sample to sample, and from pack to pack.
struct FeatureMemory {
  struct Slot {
    double state = 0.0;   ///< Output of a low pass or an integral.
    double before = 0.0;  ///< The argument one sample earlier.
  };
  bool empty = true;  ///< No sample yet.
  int samples = 0;    ///< Samples written to the delay lines; counts beyond their length.
  std::array<Slot, kMaxMemories> slot{};
  std::array<std::array<double, kMaxDelaySamples>, kMaxDelays> line{};
  PastSamples kept;  ///< For delays of sampled quantities.

  /// The next sample is the first of a run.
  void Clear() noexcept {
    empty = true;
    samples = 0;
    kept.samples = 0;
  }
};

/// One sample as expressions see it.
struct FeatureInput {
  const double* signals = nullptr;
  double t = 0.0;   ///< Plant time, s.
  double dt = 0.0;  ///< Since the previous sample, s; not used for the first sample of a run.
};

/// Everything in a plant that depends on no parameter, computed sample by sample in the order of time.
///
/// Functions with memory are exact for arguments that are linear between samples:
///
///     low pass  y <- y E + a (G - E) + b (1 - G),  E = exp(-dt / tau), G = (1 - E) tau / dt, from a to b
///     integral  y <- y + dt (a + b) / 2
///     delay     linear between the samples at t - tau; a time constant below 0 counts as 0, and one that is longer
///               than kMaxDelaySamples has no value
///
/// and for those that a third argument marks as held between samples:
///
///     low pass  y <- y E + a (1 - E);  integral  y <- y + dt a;  delay  the sample at t - tau or the last one before
class FeatureProgram {
 public:
  FeatureProgram() = default;
  /// @throws std::length_error naming the limit that is exceeded.
  FeatureProgram(const Graph& graph, const std::vector<int>& outputs);

  /// Computes the outputs at the next sample.
  /// @param input   That sample.
  /// @param memory  Of what came before it; may be null without functions with memory.
  /// @param out     out[i] = output i at this sample.
  /// @rt No heap, no lock, no throw. O(nodes).
  void Evaluate(const FeatureInput& input, FeatureMemory* memory, double* out) const noexcept ARMCMC_NONBLOCKING;

  [[nodiscard]] int num_outputs() const noexcept { return static_cast<int>(outputs_.size()); }
  [[nodiscard]] int size() const noexcept { return static_cast<int>(code_.size()); }
  [[nodiscard]] bool has_memory() const noexcept { return num_memories_ > 0; }

 private:
  struct Instruction {
    Op op = Op::kNumber;
    std::array<std::int16_t, kMaxArguments> argument{};
    double value = 0.0;
    SymbolKind kind = SymbolKind::kConstant;
    std::int16_t index = 0;  ///< Index of the signal or of the memory.
    std::int16_t line = -1;  ///< Line of a delay.
    bool held = false;       ///< Whether the argument of a function with memory is held.
  };

  std::vector<Instruction> code_;
  std::vector<std::int16_t> outputs_;
  int num_memories_ = 0;
  int num_delays_ = 0;
};

}  // namespace armcmc::expression
