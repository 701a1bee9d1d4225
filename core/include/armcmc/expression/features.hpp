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
inline constexpr int kMaxDelays = 4;           ///< Of these: delays.
inline constexpr int kMaxDelaySamples = 1024;  ///< The longest delay.

/// Samples of what is looked up in the past, as long as the longest delay.
struct PastSamples {
  int samples = 0;  ///< Of each line, counted on beyond their length.
  std::array<std::array<double, kMaxDelaySamples>, kMaxDelays> line{};
};

/// What functions with memory carry from sample to sample, and from pack to pack.
struct FeatureMemory {
  struct Slot {
    double state = 0.0;   ///< Of a low pass or an integral.
    double before = 0.0;  ///< The argument one sample earlier.
  };
  bool empty = true;  ///< No sample yet.
  int samples = 0;    ///< In the delay lines, counted on beyond their length.
  std::array<Slot, kMaxMemories> slot{};
  std::array<std::array<double, kMaxDelaySamples>, kMaxDelays> line{};
  PastSamples kept;  ///< Of delays that are sampled.

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
  double dt = 0.0;  ///< Since the sample before, s; of the first sample of a run it is not used.
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
  /// @throws std::length_error naming the limit that is passed.
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
    std::int16_t index = 0;  ///< Of a signal; of a memory.
    std::int16_t line = -1;  ///< Of a delay.
    bool held = false;       ///< Of a function with memory: what it takes is.
  };

  std::vector<Instruction> code_;
  std::vector<std::int16_t> outputs_;
  int num_memories_ = 0;
  int num_delays_ = 0;
};

}  // namespace armcmc::expression
