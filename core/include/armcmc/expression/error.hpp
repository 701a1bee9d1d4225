#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace armcmc::expression {

/// An expression that cannot be understood, or that physics does not allow.
class Error : public std::runtime_error {
 public:
  Error(int column, const std::string& what) : std::runtime_error(what), column_(column) {}
  /// Where in the text, counted in characters from 1.
  [[nodiscard]] int column() const noexcept { return column_; }

 private:
  int column_;
};

/// A name that nothing has: whoever knows what there is may say what was meant.
class UnknownName : public Error {
 public:
  /// @param kind  What was looked for: "function", "signal or parameter", ...
  UnknownName(int column, std::string_view name, std::string_view kind)
      : Error(column, "unknown " + std::string(kind) + " \"" + std::string(name) + '"'), name_(name) {}
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

 private:
  std::string name_;
};

}  // namespace armcmc::expression
