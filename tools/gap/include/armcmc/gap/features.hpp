#pragma once

#include <vector>

#include "armcmc/gap/types.hpp"

namespace armcmc::gap {

/// Of each element, by vector instructions: within some 1e-15 of the larger of the result and 1, for sizes up to 1e7 of
/// what sine and cosine are taken of.
[[nodiscard]] Vector Exp(const Vector& of);
[[nodiscard]] Vector Tanh(const Vector& of);
[[nodiscard]] Vector Sin(const Vector& of);
[[nodiscard]] Vector Cos(const Vector& of);

/// The series where `mask` is not zero, least first.
[[nodiscard]] std::vector<double> Sorted(const Vector& series, const Vector& mask);
/// `count` quantiles (1 % to 99 %) of what is sorted; equal ones once.
[[nodiscard]] Vector QuantileKnots(const std::vector<double>& sorted, int count);
/// The same of the series where `mask` is not zero.
[[nodiscard]] Vector QuantileKnots(const Vector& series, const Vector& mask, int count);
/// `count` knots from 0 to 1.
[[nodiscard]] Vector EvenKnots(int count);
/// Piecewise linear basis: column k is 1 at knot k and 0 at the others, constant beyond the ends. [row][knot]
[[nodiscard]] Matrix HatFunctions(const Vector& series, const Vector& knots);
/// Every column times `weight`.
[[nodiscard]] Matrix Gated(const Matrix& columns, const Vector& weight);
/// Columns of both.
[[nodiscard]] Matrix JoinColumns(const Matrix& left, const Matrix& right);
/// Products of every column of a with every column of b.
[[nodiscard]] Matrix Products(const Matrix& a, const Matrix& b);
/// Bristle deflection of dry friction over a distance, from speed:  z' = v / distance (1 - z sign v),  in [-1, 1].
[[nodiscard]] Vector Bristle(const Vector& velocity, double distance, double dt);

/// A spectral line: the frequency with the largest power relative to its neighbourhood.
struct Line {
  double frequency = 0.0;   ///< Hz
  double prominence = 0.0;  ///< Power over the median of the neighbouring frequencies.
};
[[nodiscard]] Line StrongestLine(const Vector& series, double dt);
/// Cosine and sine of `harmonics` multiples of the frequency. [row][2 harmonics]
[[nodiscard]] Matrix Waves(const Vector& t, double frequency, int first_harmonic, int last_harmonic);

}  // namespace armcmc::gap
