#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "armcmc/plant_sim/described_plant.hpp"
#include "armcmc/plant_sim/expression/expression.hpp"
#include "armcmc/plant_sim/input_program.hpp"
#include "armcmc/plant_sim/rng.hpp"

namespace armcmc::plant_sim {

/// An effect that the plant's file does not know.
struct HiddenTerm {
  enum class Slot : std::uint8_t {
    kOutput,  ///< Added to the output.
    kInput,  ///< What the plant sees in place of the signal `of`, which is recorded as it is. Of signals, constants, t.
    kRate    ///< Added to the rate of the state `of`.
  };
  Slot slot = Slot::kOutput;
  std::string of;
  std::string value;  ///< Expression.
};

/// How a described plant is simulated.
struct DescribedScenario {
  double dt = 1e-3;  ///< s, sample interval.
  double duration_s = 10.0;
  std::uint64_t seed = 1;  ///< Of multisines, steps and noise.
  int pack_stride = 0;     ///< Samples from pack to pack; 0: as many as a pack has.
  std::map<std::string, std::vector<double>>
      truth;                                   ///< By parameter: one value, or one a mode. Left out: the usual one.
  std::map<std::string, InputProgram> inputs;  ///< By signal.
  /// By state: its first value, in place of `start`. By output, or by a signal that is a state: what `start` reads, 0
  /// where it is left out.
  std::map<std::string, double> start;
  std::optional<NoiseLaw> noise;  ///< Of the output; left out: the plant's.
  std::vector<HiddenTerm> hidden;
};

/// A described plant in motion: from sample to sample the inputs, the states by the classical Runge-Kutta method of
/// order 4 with the inputs linear between samples, then the law of the mode that acts, hidden effects, and noise.
///
/// The interval between two samples is divided into the largest of all substeps. Where no mode's `when` holds, the
/// output is 0. In a mode a per_mode parameter is that mode's value, in rates too; in a passive one that of the last
/// mode that is none. A signal that is a state (InputProgram::kState) takes its value, its derivative the state's rate.
class DescribedSimulation {
 public:
  /// @throws DescribedError naming a key of the plant ("law") or of the scenario ("scenario.inputs.q").
  DescribedSimulation(const DescribedPlant& plant, const DescribedScenario& scenario);

  /// The next sample; the first one is at t = 0.
  void Next();

  [[nodiscard]] double t() const { return static_cast<double>(index_) * scenario_.dt; }
  /// Signals as they are measured, in the order of the file.
  [[nodiscard]] const std::vector<double>& measured() const { return measured_; }
  [[nodiscard]] double true_output() const { return true_output_; }  ///< Without noise.
  [[nodiscard]] const std::vector<double>& states() const { return state_; }
  [[nodiscard]] int mode() const { return mode_; }  ///< Place in the file; -1: none acts.

 private:
  using Expression = expression::Expression;
  /// Where a signal comes from: the derivative of that order of an input or (order 0, 1) of a state; else the output.
  struct Source {
    int input = -1, state = -1, order = 0;
  };
  struct Hidden {
    HiddenTerm::Slot slot;
    int of;
    Expression value;
  };

  void MakeNames();
  void MakeSources();
  void MakeTruth();
  void MakeExpressions();
  void MakeHidden();
  [[nodiscard]] Expression Read(const std::string& key, const std::string& text, bool sees_output = false,
                                bool is_rate = false) const;
  void RefuseMemory(const std::string& key, const Expression& rate) const;
  /// A rate, with what it remembers of signals in it.
  [[nodiscard]] Expression ReadRate(const std::string& key, const std::string& text) const;
  [[nodiscard]] std::size_t Place(const std::string& name) const;

  /// Signals at the present index that come from inputs: recorded into `signals`, as the plant sees them into `seen`.
  void MoveInputs(std::vector<double>* signals, std::vector<double>* seen);
  /// A signal at t, `part` of the way between its samples.
  [[nodiscard]] double Between(std::size_t signal, double from, double to, double part, double t);
  void Begin();
  void Advance(const std::vector<double>& from, const std::vector<double>& to);
  /// What rates remember goes on to the present sample.
  void FollowSignals(double dt);
  /// @param part  Of the way from the sample before to the present one.
  [[nodiscard]] std::vector<double> Rates(std::vector<double> frame, const std::vector<double>& state, double part);
  void PlaceStates(const std::vector<double>& state, std::vector<double>* frame) const;
  void PlaceParameters(int mode, std::vector<double>* frame) const;
  [[nodiscard]] int ModeOf(const std::vector<double>& frame, double dt, bool with_memory);
  void Law(std::vector<double>* frame, double dt);

  DescribedPlant plant_;
  DescribedScenario scenario_;
  expression::Names names_;  ///< signals, constants, parameters, states, lets, t
  std::vector<bool> held_;   ///< By place: between samples.
  std::vector<double> frame_;
  std::vector<InputSignal> inputs_;
  std::vector<Source> sources_;             ///< By signal.
  std::vector<std::vector<double>> truth_;  ///< [parameter][mode]
  std::vector<Expression> lets_, whens_, laws_, rates_, starts_;
  std::vector<bool> late_, remembers_;  ///< By let: depends on a per_mode parameter; on what has a memory.
  std::optional<Expression> predicts_;
  std::vector<Hidden> hidden_;
  NoiseLaw noise_;
  Rng rng_;
  int output_ = 0, last_active_ = 0;
  long long index_ = -1;
  int mode_ = -1;
  std::vector<double> state_, signals_, seen_, measured_;
  double true_output_ = 0.0;
};

/// Signals that need a program of their own: no output, no derivative, and no state that measures them or starts there.
[[nodiscard]] std::vector<std::string> InputsToMove(const DescribedPlant& plant);

/// Truth at the usual values, multisines whose size and band follow from the roles of the inputs, signals that are
/// states where measured_by or `start` says so; 10 s at 1 kHz.
[[nodiscard]] DescribedScenario UsualScenario(const DescribedPlant& plant);

}  // namespace armcmc::plant_sim
