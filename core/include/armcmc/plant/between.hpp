#pragma once

#include <cstdint>
#include <string_view>

#include "armcmc/nonblocking.hpp"

namespace armcmc {

/// Course of a signal between two samples, for the integration of states: `between` in a plant file.
enum class Between : std::uint8_t {
  kLinear,  ///< Straight line between the samples; the default.
  kHeld,    ///< Keeps the value of the last sample: a command from a computer.
  kSmooth,  ///< The cubic through the four samples around; at an end of the known samples, the parabola through three.
};

/// From the word in a plant file; any other word is kLinear.
[[nodiscard]] constexpr Between BetweenNamed(std::string_view word) noexcept {
  return word == "held" ? Between::kHeld : word == "smooth" ? Between::kSmooth : Between::kLinear;
}

/// Value of a signal between two samples. With s the position in the interval, y_0 = from and y_1 = to:
///
///   held    y_0
///   linear  y_0 + s (y_1 - y_0)
///   smooth  the polynomial through the available samples y_-1, y_0, y_1, y_2, in Newton's form
///
/// @param between         Course of the signal.
/// @param from, to        Samples at the ends of the interval.
/// @param earlier, later  The sample before `from` and the one after `to`; null if unknown.
/// @param part            s, in [0, 1].
/// @rt No heap, no lock, no throw. O(1).
[[nodiscard]] inline double ValueBetween(Between between, const double* earlier, double from, double to,
                                         const double* later, double part) noexcept ARMCMC_NONBLOCKING {
  if (between == Between::kHeld) return from;
  const double linear = from + part * (to - from);
  if (between == Between::kLinear || (earlier == nullptr && later == nullptr)) return linear;
  // Newton's form of the polynomial through the available samples.
  const double before = earlier != nullptr ? to - 2.0 * from + *earlier : 0.0;  // second differences
  const double after = later != nullptr ? *later - 2.0 * to + from : 0.0;
  const double parabola = linear + 0.5 * part * (part - 1.0) * (earlier != nullptr ? before : after);
  if (earlier == nullptr || later == nullptr) return parabola;
  return parabola + part * (part * part - 1.0) / 6.0 * (after - before);
}

}  // namespace armcmc
