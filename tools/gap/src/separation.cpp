#include "armcmc/gap/separation.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

namespace armcmc::gap {
namespace {

using Eigen::Index;

constexpr double kConfounded = 5.0;      // standard deviation over that with all others held fixed
constexpr double kUncertain = 0.5;       // of the value: a smaller standard deviation says enough by itself
constexpr std::size_t kMostMembers = 3;  // of a combination: a longer one says little
constexpr double kRounding = 0.3;  // of the combination's standard deviation, that rounding one coefficient may add

/// The covariance of the free parameters in units of their standard deviations with all others held fixed.
struct Scaled {
  std::vector<std::size_t> free;  ///< Those that were not held fixed.
  Vector unit;                    ///< [place in `free`]
  Matrix covariance;              ///< [place in `free`][place in `free`]
};

Scaled ScaledBy(const Matrix& covariance) {
  constexpr double kJitter = 1e-13;
  Scaled scaled;
  std::vector<Index> at;
  for (Index i = 0; i < covariance.rows(); ++i) {
    if (!(covariance(i, i) > 0.0)) continue;
    scaled.free.push_back(static_cast<std::size_t>(i));
    at.push_back(i);
  }
  const Matrix open = covariance(at, at);
  const Vector sd = open.diagonal().cwiseSqrt(), inverse = sd.cwiseInverse();
  Matrix correlation = inverse.asDiagonal() * open * inverse.asDiagonal();
  correlation.diagonal().array() += kJitter;
  const Matrix precision = correlation.ldlt().solve(Matrix::Identity(open.rows(), open.cols()));
  scaled.unit = sd.cwiseQuotient(precision.diagonal().cwiseMax(1.0).cwiseSqrt());
  scaled.covariance = scaled.unit.cwiseInverse().asDiagonal() * open * scaled.unit.cwiseInverse().asDiagonal();
  return scaled;
}

/// Covariance given the parameter at `pivot`.
void Condition(Index pivot, Matrix* covariance) {
  const Vector column = covariance->col(pivot);
  *covariance -= column * column.transpose() / column[pivot];
}

/// The number with the fewest digits within `tolerance` of `exact`.
double Rounded(double exact, double tolerance) {
  char text[32];
  for (int digits = 1; digits < 17; ++digits) {
    std::snprintf(text, sizeof(text), "%.*g", digits, exact);
    const double value = std::strtod(text, nullptr);
    if (std::abs(value - exact) <= tolerance) return value;
  }
  return exact;
}

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.6g", value);
  return text;
}

bool HasUnit(const std::string& unit) { return !unit.empty() && unit != "1"; }

/// The combination of parameters with these coefficients, of which that of `first` is 1.
Combination Combined(const std::vector<FittedParameter>& parameters, std::size_t first, const Vector& coefficients,
                     const Matrix& covariance) {
  std::vector<std::size_t> members{first};
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (i != first && coefficients[static_cast<Index>(i)] != 0.0) members.push_back(i);
  const bool product = std::all_of(members.begin(), members.end(), [&](std::size_t i) {
    return parameters[i].logarithmic && parameters[i].value > 0.0;
  });
  Combination combination;
  const double variance = std::max(coefficients.dot(covariance * coefficients), 0.0);
  // In a sum, a logarithm counts by its change about the fit: d value = value d log(value).
  const auto in_sum = [](const FittedParameter& p) { return p.logarithmic && p.value != 0.0 ? p.value : 1.0; };
  const double whole = in_sum(parameters[first]);
  combination.value = product ? 1.0 : 0.0;
  combination.unit = product ? "" : parameters[first].unit;
  for (const std::size_t i : members) {
    const FittedParameter& p = parameters[i];
    const double c = coefficients[static_cast<Index>(i)];
    combination.parameters.push_back(p.name);
    if (product) {
      combination.value *= std::pow(p.value, c);
      const std::string power = c == 1.0 ? "" : "^" + (c < 0.0 ? "(" + Number(c) + ")" : Number(c));
      combination.text += (i == first ? "" : " * ") + p.name + power;
      if (HasUnit(p.unit))
        combination.unit += (combination.unit.empty() ? "" : " ") + (c == 1.0 ? p.unit : "(" + p.unit + ")" + power);
    } else {
      const double slope = i == first ? 1.0 : whole * c / in_sum(p);
      const double size = std::abs(slope);
      combination.value += slope * p.value;
      if (i != first) combination.text += slope < 0.0 ? " - " : " + ";
      combination.text += (size == 1.0 ? "" : Number(size) + " ") + p.name;
    }
  }
  combination.sd = (product ? combination.value : whole) * std::sqrt(variance);
  return combination;
}

}  // namespace

Separation Separate(const std::vector<FittedParameter>& parameters, const Matrix& covariance) {
  Separation separation;
  separation.confounded_with.resize(parameters.size());
  if (parameters.empty() || !covariance.allFinite()) return separation;
  const Scaled scaled = ScaledBy(covariance);
  const auto size = static_cast<Index>(scaled.free.size());
  std::vector<Index> confounded, held, rest;
  for (Index k = 0; k < size; ++k)
    if (scaled.covariance(k, k) > kConfounded * kConfounded) confounded.push_back(k);
  Matrix given = scaled.covariance;
  for (const Index k : confounded) {
    if (given(k, k) > kConfounded * kConfounded) {
      Condition(k, &given);
      held.push_back(k);
    } else {
      rest.push_back(k);
    }
  }
  if (held.empty() || rest.empty()) return separation;
  const auto uncertain = [&](Index k) {
    const FittedParameter& p = parameters[scaled.free[static_cast<std::size_t>(k)]];
    const double sd = std::sqrt(scaled.covariance(k, k)) * scaled.unit[k];
    return sd > kUncertain * (p.logarithmic ? 1.0 : std::abs(p.value));
  };
  const Matrix of_held = scaled.covariance(held, held);
  const Eigen::LDLT<Matrix> solver = of_held.ldlt();
  for (const Index k : rest) {
    const double sd = std::sqrt(std::max(given(k, k), 1.0)) * scaled.unit[k];
    const Vector slopes = solver.solve(scaled.covariance(held, std::vector<Index>{k}).col(0));
    Vector coefficients = Vector::Zero(static_cast<Index>(parameters.size()));
    std::vector<Index> group{k};
    coefficients[static_cast<Index>(scaled.free[static_cast<std::size_t>(k)])] = 1.0;
    for (std::size_t q = 0; q < held.size(); ++q) {
      const double spread = std::sqrt(scaled.covariance(held[q], held[q])) * scaled.unit[held[q]];
      const double slope = -slopes[static_cast<Index>(q)] * scaled.unit[k] / scaled.unit[held[q]];
      if (std::abs(slope) * spread < sd) continue;
      coefficients[static_cast<Index>(scaled.free[static_cast<std::size_t>(held[q])])] =
          Rounded(slope, kRounding * sd / spread);
      group.push_back(held[q]);
    }
    if (!uncertain(k) || group.size() < 2 || group.size() > kMostMembers) continue;
    separation.combinations.push_back(
        Combined(parameters, scaled.free[static_cast<std::size_t>(k)], coefficients, covariance));
    std::sort(group.begin(), group.end());
    for (const Index i : group) {
      if (!uncertain(i)) continue;
      std::vector<std::string>& with = separation.confounded_with[scaled.free[static_cast<std::size_t>(i)]];
      for (const Index other : group) {
        const std::string& name = parameters[scaled.free[static_cast<std::size_t>(other)]].name;
        if (other != i && std::find(with.begin(), with.end(), name) == with.end()) with.push_back(name);
      }
    }
  }
  return separation;
}

}  // namespace armcmc::gap
