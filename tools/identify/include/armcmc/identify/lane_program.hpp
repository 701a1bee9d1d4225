#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "armcmc/expression/graph.hpp"
#include "armcmc/expression/operation.hpp"

namespace armcmc::identify {

/// Candidates that are evaluated side by side.
inline constexpr std::size_t kLanes = 16;
/// Samples that are evaluated by one walk through the operations.
inline constexpr std::size_t kTile = 8;
/// One value of every candidate.
using Lanes = std::array<double, kLanes>;

/// Along what an input changes.
enum class Varies : std::uint8_t {
  kByLane,    ///< Every candidate has a value for all samples: a parameter.
  kBySample,  ///< All candidates have the same: a signal.
  kByBoth,    ///< A state.
};

/// What the evaluation of a program carries from sample to sample.
struct LaneRun {
  /// [sample][lane], and a line more where there are several samples: memory of one page offset would be waited for.
  template <std::size_t kSamples>
  struct alignas(64) Block {
    std::array<double, kSamples * kLanes + (kSamples > 1 ? 8 : 0)> value;
  };
  struct Slot {
    Lanes state{};            ///< Of a low pass or an integral.
    Lanes before{};           ///< The argument one sample earlier.
    Lanes decay{}, weight{};  ///< Of a low pass from one sample to the next, and of the sample before.
  };
  double dt = 1.0;                       ///< s
  bool empty = true;                     ///< No sample yet.
  std::vector<Block<1>> one;             ///< Zero, one of every instruction, room: of one sample,
  std::vector<Block<2>> pair;            ///< of one sample of twice as many candidates,
  std::vector<Block<kTile>> tile;        ///< and of several samples.
  std::vector<Slot> slot;                ///< Of every function with memory.
  std::vector<std::vector<Lanes>> line;  ///< [delay][sample of the run]

  /// The next sample is the first of a run.
  void Clear();
};

/// Expressions of a graph for several candidates side by side, over samples in the order of time.
///
/// The same values as expression::FeatureProgram has for each of them; delays reach back to the beginning of the run.
/// What only candidates differ in is computed once, and one walk through the rest serves all lanes of a few samples, so
/// that walking costs little.
class LaneProgram {
 public:
  LaneProgram() = default;
  /// @param inputs  [signal] How it changes.
  LaneProgram(const expression::Graph& graph, const std::vector<int>& outputs, const std::vector<Varies>& inputs);

  /// A run whose first sample comes next.
  /// @param input  [signal] Those that vary by lane are read.
  /// @param dt     s, from sample to sample.
  [[nodiscard]] LaneRun Begin(const Lanes* input, double dt) const;

  /// The next samples, at most kTile.
  /// @param input  [signal][sample] Those that vary by sample, a row of `stride` each.
  /// @param t      [sample] s, plant time.
  /// @param[out] out  [output][sample] in rows of `stride`.
  void Evaluate(std::size_t samples, const Lanes* input, std::size_t stride, const double* t, LaneRun* run,
                Lanes* out) const;

  /// Twice as many candidates side by side, where nothing is remembered: [signal][half].
  [[nodiscard]] LaneRun BeginPair(const Lanes* input, double dt) const;
  /// One sample of them, the same values as Evaluate() has for each half.
  /// @param input     [signal][half]
  /// @param[out] out  [output][half]
  void EvaluatePair(const Lanes* input, double t, LaneRun* run, Lanes* out) const;

  [[nodiscard]] bool has_memory() const noexcept { return num_memories_ > 0; }
  /// Whether the signal is read sample by sample.
  [[nodiscard]] bool Reads(std::size_t signal) const;

 private:
  template <std::size_t kSamples>
  using Blocks = std::vector<LaneRun::Block<kSamples>>;
  /// The one branch of a condition that an instruction serves: where the other is taken it is left out.
  struct Guard {
    std::size_t condition = 0;  ///< Block; 0: none.
    bool holds = false;
  };
  struct Instruction {
    expression::Op op = expression::Op::kNumber;
    std::array<std::size_t, expression::kMaxArguments> argument{};  ///< Blocks.
    std::size_t block = 0;                                          ///< That it fills.
    double value = 0.0;
    bool time = false, interval = false;
    bool memory = false;
    Varies varies = Varies::kByLane;
    int power = -1;         ///< Whole part of a constant exponent that is made of multiplications; else -1.
    bool half = false;      ///< And one half.
    bool root = false;      ///< A power that negative numbers do not have, or with an exponent that may be any.
    bool held = false;      ///< Of a function with memory: what it takes is, between samples.
    bool steady = false;    ///< A low pass whose time constant varies by lane at most.
    std::size_t index = 0;  ///< Of a signal; of a memory.
    std::size_t line = 0;   ///< Of a delay.
    Guard guard;
  };
  void GuardBranches();
  template <std::size_t kSamples>
  static void Compute(const Instruction& instruction, Blocks<kSamples>* blocks);
  template <std::size_t kSamples>
  void Walk(const Lanes* input, std::size_t stride, const double* t, LaneRun* run, Blocks<kSamples>* blocks,
            Lanes* out) const;
  void WalkOne(const Lanes* input, std::size_t stride, const double* t, LaneRun* run, Lanes* out) const;
  void WalkPair(const Lanes* input, const double* t, LaneRun* run, Lanes* out) const;
  void WalkTile(const Lanes* input, std::size_t stride, const double* t, LaneRun* run, Lanes* out) const;
  void ComputeOnce(Blocks<1>* blocks) const;
  static void Remember(const Instruction& instruction, bool first, const double* e, const double* tau, LaneRun* run,
                       double* y);

  std::vector<Instruction> once_, each_;  ///< Computed once a run of candidates; at each sample.
  std::vector<std::size_t> outputs_;      ///< Blocks.
  std::size_t input_size_ = 0, num_blocks_ = 1, num_memories_ = 0, num_delays_ = 0;
};

}  // namespace armcmc::identify
