#include "armcmc/tables/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "armcmc/support/text_table.hpp"

namespace armcmc::tables {
namespace {

constexpr int kIntervals = 400;  // of the angle asin(r) in [0, pi/2]
constexpr double kQuarterTurn = 0.5 * std::numbers::pi;

/// The covariance of two covers at kIntervals + 1 angles asin(r), by Simpson's rule.
std::vector<double> Covariances(double c) {
  const auto integrand = [c](double t) {
    const double s = std::sin(t);
    const double opposite = s < 1.0 ? std::exp(-c * c / (1.0 - s)) : 0.0;
    return (std::exp(-c * c / (1.0 + s)) - opposite) / std::numbers::pi;
  };
  const double h = kQuarterTurn / kIntervals;
  std::vector<double> table{0.0};
  for (int i = 0; i < kIntervals; ++i)
    table.push_back(table.back() +
                    h * (integrand(i * h) + 4.0 * integrand((i + 0.5) * h) + integrand((i + 1) * h)) / 6.0);
  return table;
}

}  // namespace

double NullCoverageVariance(std::span<const double> sd, std::size_t level) {
  static const std::array<std::vector<double>, kLevels.size()> tables{
      Covariances(kHalfWidths[0]), Covariances(kHalfWidths[1]), Covariances(kHalfWidths[2])};
  if (sd.empty()) return 0.0;
  const std::vector<double>& table = tables[level];
  double pairs = 0.0;
  for (std::size_t j = 0; j < sd.size(); ++j) {
    for (std::size_t k = 0; k < j; ++k) {
      // The wider of the two is the earlier one, but where something was forgotten in between.
      const double ratio = std::min(sd[j], sd[k]) / std::max(sd[j], sd[k]);
      // A filter whose particles are all alike has no width: nothing in it is independent.
      const double at = std::isfinite(ratio) ? kIntervals * std::asin(ratio) / kQuarterTurn : kIntervals;
      const auto i = static_cast<std::size_t>(std::min(at, kIntervals - 1.0));
      pairs += table[i] + (at - static_cast<double>(i)) * (table[i + 1] - table[i]);
    }
  }
  const auto m = static_cast<double>(sd.size());
  return (m * kLevels[level] * (1.0 - kLevels[level]) + 2.0 * pairs) / (m * m);
}

Calibration JudgeCoverage(double coverage, std::size_t level, double standard_error) {
  const double excess = coverage - kLevels[level];
  if (!(std::fabs(excess) > 2.0 * standard_error)) return Calibration::kAsStated;
  return excess < 0.0 ? Calibration::kTooNarrow : Calibration::kTooWide;
}

const char* NameOf(Calibration calibration) {
  constexpr std::array<const char*, 3> kNames{"as stated", "too narrow", "too wide"};
  return kNames[static_cast<std::size_t>(calibration)];
}

std::string CoverageText(double coverage, std::size_t level, double standard_error) {
  const Calibration calibration = JudgeCoverage(coverage, level, standard_error);
  const std::string text =
      support::Significant(100.0 * coverage, 3) + " ± " + support::Significant(100.0 * standard_error, 2);
  return calibration == Calibration::kAsStated ? text : text + ", " + NameOf(calibration);
}

}  // namespace armcmc::tables
