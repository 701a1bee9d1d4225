#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "armcmc/expression/unit.hpp"

namespace armcmc::expression {

/// What a name stands for.
enum class SymbolKind : std::uint8_t {
  kSignal,     ///< Measured: given at every sample.
  kTime,       ///< The plant's time t.
  kConstant,   ///< A number; in a graph one that is known before the first sample.
  kParameter,  ///< Sampled.
  kState,      ///< Integrated from its rate.
  kLet,        ///< Another expression.
  kGiven,      ///< A number that is computed elsewhere for every sample; in graphs only.
  kInterval,   ///< Seconds between samples; in graphs only.
};

/// Values that something can have: a closed interval, of which infinite ends are not part. Checks use it to reject, for
/// example, the square root of something that can be negative.
struct Interval {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

/// A name with what the checker knows about its value.
struct Symbol {
  std::string name;  ///< As written in expressions.
  SymbolKind kind = SymbolKind::kSignal;
  int index = 0;             ///< Among those of its kind.
  std::optional<Unit> unit;  ///< None: fits everywhere (a constant without one), or depends on a parameter.
  Interval range;
  double value = 0.0;      ///< Value of a constant.
  bool condition = false;  ///< A named expression that is true or false.
  bool sampled = false;    ///< Depends on a parameter or a state.
  bool fixed = false;      ///< A number that is known before any sample.
};

/// The names that an expression may use. Filled when a plant is set up, in the order of its file; not used on the step
/// path. Lookups are linear: a plant has a few dozen names.
class Scope {
 public:
  /// Adds a name. Pointers from Find() become invalid.
  /// @pre No symbol of that name yet.
  void Add(Symbol symbol) { symbols_.push_back(std::move(symbol)); }
  /// The symbol of a name; null if there is none. O(symbols).
  [[nodiscard]] const Symbol* Find(std::string_view name) const noexcept {
    for (const Symbol& symbol : symbols_)
      if (symbol.name == name) return &symbol;
    return nullptr;
  }
  /// All symbols, in the order in which they were added.
  [[nodiscard]] std::vector<Symbol>& symbols() noexcept { return symbols_; }
  [[nodiscard]] const std::vector<Symbol>& symbols() const noexcept { return symbols_; }
  /// All names, in the order in which they were added.
  [[nodiscard]] std::vector<std::string> Names() const;

 private:
  std::vector<Symbol> symbols_;
};

}  // namespace armcmc::expression
