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

/// A mode of a plant, as nodes of its graph.
struct PlantMode {
  std::string name;
  bool passive = false;
  int when = -1;    ///< Condition on signals; -1: always.
  int law = -1;     ///< What is predicted; of a passive mode what is shown.
  int target = -1;  ///< What the law explains.
  std::optional<expression::Unit> target_unit;
};

struct PlantState {
  int start = -1;
  int rate = -1;
  int measured_by = -1;  ///< Signal; -1: none.
};

/// A plant file that has been understood: names looked up, units counted, limits checked, everything one graph.
///
/// Signals keep the order of the file. A parameter with a lognormal prior is its logarithm where it is sampled; in the
/// graph it is exp(that).
class Plant {
 public:
  static constexpr int kMaxInputs = 8;
  static constexpr int kMaxSampled = 8;
  static constexpr int kMaxStates = 8;
  static constexpr int kMaxPlantModes = 4;
  static constexpr std::size_t kMaxNameLength = 31;  ///< What a message has room for.

  /// @throws PlantError.
  explicit Plant(PlantDescription description);

  [[nodiscard]] const PlantDescription& description() const noexcept { return description_; }
  [[nodiscard]] const expression::Graph& graph() const noexcept { return graph_; }
  [[nodiscard]] const expression::Scope& scope() const noexcept { return scope_; }
  [[nodiscard]] const std::vector<PlantMode>& modes() const noexcept { return modes_; }
  [[nodiscard]] const std::vector<PlantState>& states() const noexcept { return states_; }
  [[nodiscard]] int predicts() const noexcept { return predicts_; }  ///< Node, -1: the law.
  [[nodiscard]] const std::vector<int>& reports() const noexcept { return reports_; }
  [[nodiscard]] int output() const noexcept { return output_; }  ///< Signal.
  /// Node of a signal, a parameter or a state.
  [[nodiscard]] int NodeOf(expression::SymbolKind kind, int index) const;
  /// Signals of that role, in the order of the file.
  [[nodiscard]] std::vector<int> SignalsWithRole(std::string_view role) const;

  /// Distinguishes plants by their signals: name, unit and role of each, in order, and which is the output. Packs of
  /// one plant fit every plant with the same fingerprint and name.
  [[nodiscard]] std::uint64_t fingerprint() const noexcept { return fingerprint_; }
  /// Distinguishes plants by everything that decides what they compute but priors and noise.
  [[nodiscard]] std::uint64_t identity() const noexcept { return identity_; }

 private:
  void AddSignals();
  void AddConstants();
  void AddParameters();
  void AddStates();
  void AddLets();
  void AddModes();
  void AddRates();
  void AddReports();
  /// Functions with memory of what is held between samples.
  void UseHeldForms();
  void CheckParametersAreFelt() const;
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
  std::vector<int> lets_;
  std::vector<PlantMode> modes_;
  std::vector<PlantState> states_;
  std::vector<int> reports_;
  int predicts_ = -1;
  int output_ = -1;
  std::uint64_t fingerprint_ = 0;
  std::uint64_t identity_ = 0;
  std::map<std::string, int> mentions_;  ///< How often a text says a name.
};

}  // namespace armcmc
