#pragma once

#include <array>
#include <vector>

#include "armcmc/expression/graph.hpp"
#include "armcmc/gap/effect_form.hpp"
#include "armcmc/gap/signals.hpp"

namespace armcmc::gap {

/// What an expression of a form may read at every sample, besides t, dt, coordinates and states. The order is that of
/// kFormSignals.
enum class FormSignal : std::uint8_t {
  kPosition,
  kVelocity,
  kAcceleration,
  kPressure,
  kOpening,
  kActive,      ///< 1 where the law acts.
  kRetreating,  ///< Probability that the true velocity is negative, given the smoothed one.
  kLaw,         ///< The series that a filter is given.
  kDrive,       ///< Of a simulated motion: acceleration by the input,
  kBase,        ///< and acceleration of the law without effects.
  kCount,
};
inline constexpr std::size_t kNumFormSignals = static_cast<std::size_t>(FormSignal::kCount);
static_assert(static_cast<int>(FormSignal::kOpening) == static_cast<int>(Role::kOpening));
inline constexpr std::array<const char*, kNumFormSignals> kFormSignals{"x",      "v",          "a",   "p",     "u",
                                                                       "active", "retreating", "law", "drive", "base"};

/// Straight-line code for some nodes of a graph, for one sample or for a whole recording. States are given.
///
/// Symbols: signals by FormSignal; kTime; kInterval, seconds between samples; parameters by index into `values`.
class FormCode {
 public:
  FormCode() = default;
  /// @throws std::invalid_argument for a function with memory other than previous and the delay of an input, and for
  ///         more than kMostRegisters.
  FormCode(const expression::Graph& graph, const std::vector<int>& outputs);

  static constexpr std::size_t kMostRegisters = 96;

  struct Sample {
    std::array<double, kNumFormSignals + 2> signal;  ///< Then t and dt.
    const double* values;
    const double* states;
  };
  /// The outputs at one sample. @pre No function with memory.
  void AtSample(const Sample& sample, double* outputs) const;

  struct Recording {
    const Signals& signals;
    const Vector* retreating;  ///< Null where no output reads it,
    const Vector* law;         ///< nor this.
    const double* values;
    const std::vector<Vector>& states;
  };
  /// The outputs over a recording; one that is the same at every sample has all its rows, too.
  [[nodiscard]] std::vector<Vector> OverRecording(const Recording& recording) const;

  [[nodiscard]] bool Reads(FormSignal signal) const;

 private:
  enum class From : std::uint8_t { kSignals, kValues, kStates, kNumbers };
  static constexpr int kTimeIndex = static_cast<int>(kNumFormSignals), kIntervalIndex = kTimeIndex + 1;
  /// What the first registers hold.
  struct Load {
    From from;
    int index;
  };
  struct Operation {
    expression::Op op;
    std::array<int, expression::kMaxArguments> argument;  ///< Registers.
    int whole;                                            ///< Exponent of a power that is a small whole number; else 0.
  };
  [[nodiscard]] Load LoadOf(const expression::GraphNode& node);
  [[nodiscard]] std::size_t num_registers() const { return loads_.size() + operations_.size(); }

  std::vector<Load> loads_;
  std::vector<double> numbers_;
  std::vector<Operation> operations_;
  std::vector<int> outputs_;
};

}  // namespace armcmc::gap
