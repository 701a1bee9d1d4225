#pragma once

#include <optional>
#include <string_view>

#include "armcmc/expression/scope.hpp"
#include "armcmc/expression/syntax.hpp"

namespace armcmc::expression {

/// What is known about an expression before any sample.
struct Meaning {
  std::optional<Unit> unit;  ///< None: not determined, as where an exponent is a parameter.
  Interval range;            ///< Values that it can have.
  bool condition = false;    ///< True or false.
  bool sampled = false;      ///< Depends on a parameter or a state.
  bool fixed = false;        ///< A number that is known now.
  bool memory = false;       ///< Depends on earlier samples.
  /// Column of a power that is NaN for some parameters or states: its base can be negative, and its exponent is not a
  /// whole number. 0: there is none.
  int doubtful_power = 0;
};

/// Looks up names, checks units, and finds what cannot be computed:
///   - names that `scope` does not have;
///   - a number where a condition is needed, as in if(x, ..);
///   - sums and comparisons of unlike units, functions of arguments with a unit, time constants not in seconds. What
///     has no unit of its own (numbers, constants without one) fits in a sum, and is a plain number in a product;
///     constants without one fit in a product, too;
///   - x^p where p is not a whole number and the measured x can be negative. What `x >= 0` guards is not.
///
/// @param syntax  The expression.
/// @param scope   What names mean.
/// @param given   A condition that holds wherever the expression is evaluated (a mode's `when`), or null.
/// @throws Error with the column.
[[nodiscard]] Meaning Check(const Syntax& syntax, const Scope& scope, const Syntax* given = nullptr);

/// Throws unless the expression has that unit as far as both are known. `what` begins the message.
void Expect(const Meaning& meaning, const std::optional<Unit>& unit, const Syntax& syntax, std::string_view what);

}  // namespace armcmc::expression
