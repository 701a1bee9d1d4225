#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "armcmc/expression/check.hpp"
#include "armcmc/expression/graph.hpp"
#include "armcmc/expression/scope.hpp"
#include "armcmc/plant/description.hpp"
#include "armcmc/plant/error.hpp"

namespace armcmc {

/// A mode of a plant. Conditions and laws are nodes of the graph.
struct PlantMode {
  std::string name;
  bool passive = false;
  int when = -1;                                ///< Condition on signals; -1: always.
  int law = -1;                                 ///< What is predicted; of a passive mode what is shown.
  int target = -1;                              ///< What the law explains.
  std::optional<expression::Unit> target_unit;  ///< None: fits everywhere.
};

/// A state of a plant: d state/dt = rate, state = start at the first sample. Nodes of the graph.
struct PlantState {
  int start = -1;
  int rate = -1;
  int measured_by = -1;  ///< Signal; -1: none.
};

/// What is allowed in a plant and may still be a mistake: the key of the value, the position in it, from 1, and an
/// explanation.
struct PlantNote {
  std::string key;
  int column = 0;
  std::string text;
};

/// A plant description after all checks: names are resolved, units are consistent, limits are kept, and all expressions
/// are one graph.
///
/// Signals keep the order of the file. A parameter with a lognormal prior is sampled as its logarithm; in the graph it
/// is the exponential of that symbol. Immutable after construction, so that threads may share it. Not for the step
/// path: PlantProgram compiles it for the estimator.
class Plant {
 public:
  /// Limits: signals besides the output, sampled parameters of a mode, states, modes.
  static constexpr int kMaxInputs = 8;
  static constexpr int kMaxSampled = 8;
  static constexpr int kMaxStates = 8;
  static constexpr int kMaxPlantModes = 4;
  static constexpr std::size_t kMaxNameLength = 31;  ///< Room in a message.

  /// Checks a description and builds the graph.
  /// @throws PlantError  naming the key, the position and what is wrong: an unknown name, units that do not fit, more
  ///   of something than the limits allow, a parameter that influences nothing.
  explicit Plant(PlantDescription description);

  /// The description as it was given.
  [[nodiscard]] const PlantDescription& description() const noexcept { return description_; }
  /// All expressions. Node numbers below refer to it.
  [[nodiscard]] const expression::Graph& graph() const noexcept { return graph_; }
  /// All names that expressions of this plant may use.
  [[nodiscard]] const expression::Scope& scope() const noexcept { return scope_; }
  /// Modes in the order of the file; the first whose condition holds acts. At least one.
  [[nodiscard]] const std::vector<PlantMode>& modes() const noexcept { return modes_; }
  /// States in the order of the file; may be empty.
  [[nodiscard]] const std::vector<PlantState>& states() const noexcept { return states_; }
  /// Node of the prediction of the output; -1: the law predicts it.
  [[nodiscard]] int predicts() const noexcept { return predicts_; }
  /// Nodes of the additional published quantities, in the order of the file.
  [[nodiscard]] const std::vector<int>& reports() const noexcept { return reports_; }
  /// What may be a mistake, in the order of the checks.
  [[nodiscard]] const std::vector<PlantNote>& notes() const noexcept { return notes_; }
  /// Index of the output among the signals.
  [[nodiscard]] int output() const noexcept { return output_; }
  /// Node of a signal, a parameter or a state.
  /// @param kind   kSignal, kParameter or kState.
  /// @param index  Among those of its kind, in the order of the file.
  [[nodiscard]] int NodeOf(expression::SymbolKind kind, int index) const;
  /// Indices of the signals with a role, such as "velocity", in the order of the file.
  [[nodiscard]] std::vector<int> SignalsWithRole(std::string_view role) const;

  /// Hash of the signals: name, unit and role of each, in order, and which is the output. Packs of a plant fit every
  /// plant with the same name and fingerprint.
  [[nodiscard]] std::uint64_t fingerprint() const noexcept { return fingerprint_; }
  /// Hash of everything that determines what the plant computes, except priors and noise.
  [[nodiscard]] std::uint64_t identity() const noexcept { return identity_; }

 private:
  void AddSignals();     ///< Signals and the output, with their units; the fingerprint.
  void AddConstants();   ///< Numbers with units.
  void AddParameters();  ///< Priors and bounds; lognormal ones as exp of their symbol.
  void AddStates();      ///< Names, units and starts; the rates follow, since they may use everything.
  void AddLets();        ///< In order: each may use those before it.
  void AddModes();       ///< Conditions, laws and targets.
  void AddRates();       ///< Rates of the states.
  void AddReports();     ///< Additional published quantities.
  /// Functions with memory of what is held between samples.
  void UseHeldForms();
  /// @throws PlantError  for a parameter that influences neither a law nor a state.
  void CheckParametersHaveInfluence() const;
  /// Sets fingerprint() and identity().
  void Identify();
  void AddSymbol(const std::string& key, expression::Symbol symbol);
  [[nodiscard]] std::optional<expression::Unit> UnitAt(const std::string& key, const std::string& text) const;
  [[nodiscard]] int SignalAt(const std::string& key, const std::string& name) const;

  struct Lowered {
    int node = -1;
    expression::Meaning meaning;
  };
  /// Reads, checks and lowers one text. @param unit  That it must have, as far as both are known.
  Lowered Lower(const std::string& key, const std::string& text, const std::optional<expression::Unit>& unit = {},
                std::string_view what = "", const std::string& given = "");

  PlantDescription description_;
  expression::Graph graph_;
  expression::Scope scope_;
  std::vector<int> lets_;  ///< Nodes of the named subexpressions.
  std::vector<PlantMode> modes_;
  std::vector<PlantState> states_;
  std::vector<int> reports_;
  std::vector<PlantNote> notes_;
  int predicts_ = -1;
  int output_ = -1;
  std::uint64_t fingerprint_ = 0;
  std::uint64_t identity_ = 0;
  std::map<std::string, int> mentions_;  ///< How often the texts mention a name.
};

}  // namespace armcmc
