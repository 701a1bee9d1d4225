#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "armcmc/expression/error.hpp"
#include "armcmc/expression/operation.hpp"

namespace armcmc::expression {

/// One node of an expression as it was written.
struct SyntaxNode {
  Op op = Op::kNumber;
  std::array<int, kMaxArguments> argument{-1, -1, -1};  ///< Nodes, all before this one.
  double value = 0.0;                                   ///< Value of a number.
  std::string name;                                     ///< Name of a symbol.
  int column = 1;                                       ///< Position of a number, a name or an operator; from 1.
};

/// An expression as a tree: arguments precede what uses them; the root is the last node.
struct Syntax {
  std::vector<SyntaxNode> nodes;

  [[nodiscard]] int root() const noexcept { return static_cast<int>(nodes.size()) - 1; }
  [[nodiscard]] const SyntaxNode& at(int node) const { return nodes.at(static_cast<std::size_t>(node)); }
  /// Column of the first character that belongs to the node.
  [[nodiscard]] int FirstColumn(int node) const;
};

inline constexpr int kMaxTextLength = 4096;
inline constexpr int kMaxNesting = 64;  ///< Nesting of parentheses, signs and powers.

/// Reads
///
///     or       := and { "or" and }
///     and      := not { "and" not }
///     not      := "not" not | relation
///     relation := sum [ ("<" | "<=" | ">" | ">=" | "==" | "!=") sum ]
///     sum      := product { ("+" | "-") product }
///     product  := signed { ("*" | "/") signed }
///     signed   := ("-" | "+") signed | power
///     power    := atom [ "^" signed ]                       right associative, binds before a sign
///     atom     := number | name | name "(" [ or { "," or } ] ")" | "(" or ")"
///
/// a > b becomes b < a. Names are not looked up here. Numbers are read as in the C locale.
///
/// @throws Error with what was found and what was expected.
[[nodiscard]] Syntax Parse(std::string_view text);

/// True for a name that may be defined: [A-Za-z_][A-Za-z0-9_]*, and neither a keyword nor a function of the
/// language.
[[nodiscard]] bool IsFreeName(std::string_view name) noexcept;

}  // namespace armcmc::expression
