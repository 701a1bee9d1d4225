#pragma once

#include <array>
#include <vector>

#include "armcmc/data_pack.hpp"
#include "armcmc/expression/features.hpp"
#include "armcmc/expression/graph.hpp"
#include "armcmc/expression/tape.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/plant/between.hpp"
#include "armcmc/plant/plant.hpp"
#include "armcmc/plant/state_run.hpp"

namespace armcmc {

/// All signals of a plant at one sample, in the order of its file.
using PlantSignals = std::array<double, Plant::kMaxInputs + 1>;

/// Sample n of a pack: the output comes from y, the others in their order from u.
/// @rt No heap, no lock, no throw. O(signals).
inline void SignalsAt(const DataPack& pack, int n, int output, PlantSignals* signals) noexcept ARMCMC_NONBLOCKING {
  const auto in = static_cast<std::size_t>(n);
  for (std::size_t s = 0, column = 0; s <= static_cast<std::size_t>(pack.num_inputs) && s < signals->size(); ++s)
    (*signals)[s] = s == static_cast<std::size_t>(output) ? pack.y[in] : pack.u[in][column++];
}

/// What expressions read at one sample as signals: first the plant's, then functions with memory that rates read, then
/// the places of the sample in the lines of kept samples.
struct PlantPoint {
  static constexpr int kMaxRemembered = 8;
  static constexpr int kFirstRemembered = Plant::kMaxInputs + 1;
  static constexpr int kFirstPosition = kFirstRemembered + kMaxRemembered;
  static constexpr int kSize = kFirstPosition + expression::kMaxDelays;
  using Values = std::array<double, kSize>;
};

/// A function with memory as a state z of what it takes, a at the beginning of a step of h and b at its end:
///
///     lowpass(e, tau)  z <- b + E (z - a) - G (b - a),  E = exp(-h / tau), G = (1 - E) tau / h
///     integral(e)      z <- z + h (a + b) / 2
///     delay(x, tau)    of a state x: one that starts like x, and from tau on has the rate that x had tau before
struct RememberedState {
  int state = 0;      ///< Its number.
  int argument = -1;  ///< Node.
  int tau = -1;       ///< Node; -1: an integral.
  int late = -1;      ///< State that it delays; -1: none, it is a low pass or an integral.
  int rate = -1;      ///< Rate of a delayed one: node.
};

/// What one pack of a plant with states leaves to the next.
struct StateMemory {
  bool known = false;                      ///< There is a previous pack.
  std::array<double, kMaxStates> state{};  ///< At its last sample, for the mean of the posterior after it.
  PlantPoint::Values point{};              ///< Signals of its last sample; places are those in the next pack.
};

/// The states of a described plant, compiled: their starts and a step of Runge-Kutta's method as tapes, and everything
/// in them that no parameter and no state changes as programs of signals. What the stages of a step have in common is
/// computed once.
///
/// A pack that continues another starts from the end of that one's trajectory for the posterior's mean, one interval
/// before its first sample; a state that is measured, from its signal there. Any other pack starts at its first sample
/// from the file's `start` or the signal.
class PlantStates {
 public:
  /// None.
  PlantStates() = default;
  /// @param plant           Whose states they are.
  /// @param graph           Of its rates and starts; nodes are added to it.
  /// @param rates, starts   One node of the graph per state, parameters replaced by those that are sampled.
  /// @param num_parameters  That are sampled.
  /// @param remembered      The last ones of them that are functions with memory.
  /// @param held_inputs     [of a point, from kFirstRemembered on] Held between samples, not linear.
  /// @param scalars         Of a sample, shared with the laws: those of the starts.
  /// @throws PlantError where the plant exceeds a limit.
  PlantStates(const Plant& plant, expression::Graph* graph, const std::vector<int>& rates,
              const std::vector<int>& starts, const std::vector<RememberedState>& remembered,
              const std::vector<bool>& held_inputs, int num_parameters, std::vector<int>* scalars);

  [[nodiscard]] int size() const noexcept { return size_; }
  [[nodiscard]] int substeps() const noexcept { return substeps_; }
  /// The state begins with a signal, not with its value at the end of the previous pack.
  [[nodiscard]] bool is_measured(int state) const noexcept {
    return measured_by_[static_cast<std::size_t>(state)] >= 0;
  }
  /// d start / d output: how much of the output's noise the start has.
  [[nodiscard]] double output_in_start(int state) const noexcept {
    return output_in_start_[static_cast<std::size_t>(state)];
  }
  /// The start is a number or a signal: it depends on no parameter.
  [[nodiscard]] bool has_given_start(int state) const noexcept { return given_start_[static_cast<std::size_t>(state)]; }
  [[nodiscard]] const expression::Tape& step() const noexcept { return step_; }

  /// Prepares the pack for integration.
  /// @param pack    Whose samples are its steps.
  /// @param point   Of each of its samples.
  /// @param before  From the previous pack, if this one continues it; else null.
  /// @param out     What the integration reads.
  /// @return false where the pack has more samples than fit, or a start that is not finite.
  /// @rt No heap, no lock, no throw. O(samples x substeps x operations of the rates).
  [[nodiscard]] bool Prepare(const DataPack& pack, const PlantPoint::Values* point, const StateMemory* before,
                             StateRun* out) const noexcept ARMCMC_NONBLOCKING;

 private:
  void CompileStep(expression::Graph* graph, const std::vector<int>& rates,
                   const std::vector<RememberedState>& remembered, int num_parameters);

  int size_ = 0;
  int substeps_ = 1;
  bool all_measured_ = false;
  std::array<Between, PlantPoint::kSize> between_{};  ///< Interpolation of each entry of a point.
  std::array<int, kMaxStates> measured_by_{};         ///< Signal, -1: none.
  std::array<double, kMaxStates> output_in_start_{};
  std::array<bool, kMaxStates> given_start_{};
  expression::Tape step_, start_;
  expression::FeatureProgram inputs_;   ///< What the rates need of the signals, at one point.
  expression::FeatureProgram scalars_;  ///< Those of a step, from its length and the inputs at its three points.
};

}  // namespace armcmc
