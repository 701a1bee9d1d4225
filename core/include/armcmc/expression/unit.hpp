#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "armcmc/expression/error.hpp"

namespace armcmc::expression {

/// A product of powers of the SI's base units, times a number. Angles are numbers: rad is 1, deg is pi/180.
struct Unit {
  static constexpr std::size_t kBases = 7;  ///< m kg s A K mol cd.
  double scale = 1.0;                       ///< Value in SI units of one of these.
  std::array<double, kBases> exponent{};

  /// Whether the dimensions are equal.
  [[nodiscard]] bool SameDimension(const Unit& other) const noexcept;
  /// Whether dimension and size are equal, so that values may be added without a factor.
  [[nodiscard]] bool Same(const Unit& other) const noexcept;
  [[nodiscard]] bool IsNumber() const noexcept { return SameDimension(Unit{}); }

  [[nodiscard]] Unit Times(const Unit& other) const noexcept;
  [[nodiscard]] Unit Over(const Unit& other) const noexcept { return Times(other.Power(-1.0)); }
  [[nodiscard]] Unit Power(double exponent) const noexcept;

  /// In the usual notation where there is one: "N", "m/s", "Pa^0.5 s/m". What ParseUnit reads.
  [[nodiscard]] std::string Text() const;
};

/// Reads a unit such as "N s/m", "kg m^2", "1", "mV", "sqrt(Pa) s/Pa^2", "N s/m^(p+1)".
///
///     unit   := factor { [" " | "*" | "/"] factor }       "/" divides by the next factor only
///     factor := name | number | "sqrt(" unit ")" | "(" unit ")", each with [ "^" exponent ]
///
/// Names are those of the SI with their prefixes, and a few others that laboratories use.
///
/// @return nothing where an exponent depends on a name, as in "N/m^p": such a unit is valid, but cannot be checked.
/// @throws Error with the column.
[[nodiscard]] std::optional<Unit> ParseUnit(std::string_view text);

}  // namespace armcmc::expression
