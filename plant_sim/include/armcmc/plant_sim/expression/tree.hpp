#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace armcmc::plant_sim::expression {

/// The text is not an expression, or contains an unknown name.
class Error : public std::runtime_error {
 public:
  Error(int column, const std::string& what) : std::runtime_error(what), column_(column) {}
  /// Character of the text, from 1.
  [[nodiscard]] int column() const noexcept { return column_; }

 private:
  int column_;
};

enum class Kind : std::uint8_t { kNumber, kName, kOperator, kFunction };

/// An expression as a tree of its own nodes.
struct Tree {
  Kind kind = Kind::kNumber;
  std::string text;  ///< Name, operator as it is written ("neg" for the sign), or function.
  double number = 0.0;
  int column = 1;
  int slot = -1;  ///< Of a name: its place among the values. Of a function with memory: its place among the memories.
  bool held = false;  ///< Its value is, between samples.
  /// Of a function with memory: what it takes is held; of a delay, where nothing integrates it: between samples nobody
  /// asks for the mean.
  bool takes_held = false;
  std::vector<Tree> arguments;
};

/// Reads the expression language of plant files, by precedence from the weakest:
///
///   or | and | not | < <= > >= == != (once) | + - | * / | sign | ^ (right associative) | number, name, f(..), (..)
///
/// @throws Error with what was found and what was expected.
[[nodiscard]] Tree Parse(std::string_view text);

/// True for lowpass, delay, integral, previous and elapsed.
[[nodiscard]] bool HasMemory(const Tree& node);

}  // namespace armcmc::plant_sim::expression
