#pragma once

#include <string>
#include <vector>

#include "armcmc/compare/trace.hpp"

namespace armcmc::compare {

/// One row of the table of differences; NaN where a run has no such number.
struct MeritRow {
  std::string what, unit;
  double a = 0.0, b = 0.0;
};

/// Residual, evidence, decisions, draws, effective samples and times of both runs.
[[nodiscard]] std::vector<MeritRow> FiguresOfMerit(const RunTrace& a, const RunTrace& b);

/// The last estimate of a quantity in both runs; a pointer is null where a run does not know it.
struct EstimatePair {
  const QuantityTrace* a = nullptr;
  const QuantityTrace* b = nullptr;
  [[nodiscard]] const QuantityTrace& any() const { return a != nullptr ? *a : *b; }
  /// Difference over its standard deviation as if the runs were independent; NaN unless both know it.
  [[nodiscard]] double distance() const;
};
[[nodiscard]] std::vector<EstimatePair> PairsOf(const RunTrace& a, const RunTrace& b);

}  // namespace armcmc::compare
