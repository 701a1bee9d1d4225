#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace armcmc::expression {

/// An expression that cannot be parsed, or whose units or ranges are inconsistent. Thrown while a plant is set up
/// (Parse, Check, ParseUnit), never by an evaluation.
///
/// what() says what was expected and what was found, without the text of the expression and its file, which the caller
/// adds: `expected the end, found ")"`.
class Error : public std::runtime_error {
 public:
  /// @param column  Position in the text, in characters from 1.
  /// @param what    What is wrong, in one line.
  Error(int column, const std::string& what) : std::runtime_error(what), column_(column) {}
  /// Position in the text, in characters from 1.
  [[nodiscard]] int column() const noexcept { return column_; }

 private:
  int column_;
};

/// A name that is not defined. The caller knows which names are, and may suggest the nearest one. Plant makes a
/// PlantError of it, with the names in PlantError::known().
class UnknownName : public Error {
 public:
  /// @param column  Position of the name in the text, in characters from 1.
  /// @param name    As written in the text.
  /// @param kind    What was expected: "function", "signal or parameter", ...
  UnknownName(int column, std::string_view name, std::string_view kind)
      : Error(column, "unknown " + std::string(kind) + " \"" + std::string(name) + '"'), name_(name) {}
  /// The name as written in the text.
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

 private:
  std::string name_;
};

}  // namespace armcmc::expression
