#pragma once

#include <array>
#include <string>
#include <vector>

#include "armcmc/gap_bench/case.hpp"

namespace armcmc::gap_bench {

/// Counts of one row of the table.
struct Row {
  std::string stratum, group;
  std::array<int, kNumGrades> count{};
  /// Cases that count: all but those that the plant could not make or that do not show their effect.
  [[nodiscard]] int counted() const;
  [[nodiscard]] int of(Grade grade) const { return count[static_cast<std::size_t>(grade)]; }
};

/// A number that a gate holds.
struct Gate {
  std::string stratum, metric;
  double value = 0.0, limit = 0.0;
  bool at_least = true;  ///< The value must not be below the limit; otherwise not above it.
  int n = 0;             ///< Cases behind it.
  [[nodiscard]] bool passed() const { return at_least ? value >= limit : value <= limit; }
};

/// Printed probabilities against what came true.
struct Bin {
  double low = 0.0, high = 0.0;
  int n = 0;
  double printed = 0.0, right = 0.0;  ///< Means.
};
struct Calibration {
  std::vector<Bin> bins;  ///< Ten, equally wide.
  int n = 0;
  double error = 0.0;  ///< Expected calibration error: mean |printed - right| over bins, weighted by their cases.
};

/// Truth against answer of the cases with one hidden effect of the catalogue and R >= 0.3.
struct Confusion {
  std::vector<std::string> names;       ///< Of effects, for the rows.
  std::vector<std::string> answers;     ///< Of effects, then "tie", "pair", "unnamed", "none".
  std::vector<std::vector<int>> count;  ///< [name][answer]
};

/// Answers printed with a probability of 0.9 or more.
struct ConfidentLabels {
  int n = 0, right = 0;
};

/// Named beginnings of effects that begin during a recording, of those that were found. Errors count beyond the
/// times at which the data cannot tell the onset apart, see OnsetInterval.
struct Onsets {
  int n = 0;                                       ///< Found.
  int dated = 0;                                   ///< With a time, not "always" or a mode.
  double within_20_ms = 0.0, within_200_ms = 0.0;  ///< Shares of n.
  double off_within_200_ms = 0.0;                  ///< Share of n, from the true onset itself.
  double median_s = 0.0, quantile90_s = 0.0;       ///< Of the errors of those that were dated; NaN of none.
};

/// Whether a case counts: it could be made, and shows its effect.
[[nodiscard]] bool Counts(const Outcome& outcome);
[[nodiscard]] std::vector<Row> Rows(const std::vector<Outcome>& outcomes);
[[nodiscard]] Calibration Calibrate(const std::vector<Outcome>& outcomes);
/// @param imperfect  Of the strata in which the plant is not the catalogue, instead of the others.
[[nodiscard]] Confusion Confuse(const std::vector<Outcome>& outcomes, bool imperfect = false);
/// Gates of those strata that have cases.
[[nodiscard]] std::vector<Gate> Gates(const std::vector<Outcome>& outcomes);
/// Whether a case counts for the gap: one effect or two with R >= 1, found.
[[nodiscard]] bool ShownClosed(const Outcome& outcome);
/// Share of the gap that is closed on held-out data, of those.
[[nodiscard]] std::vector<double> Closures(const std::vector<Outcome>& outcomes);
[[nodiscard]] Onsets LocateOnsets(const std::vector<Outcome>& outcomes);
[[nodiscard]] ConfidentLabels CountConfident(const std::vector<Outcome>& outcomes);
/// Value below which `share` of the values lie, linear between them; NaN of none.
[[nodiscard]] double Quantile(std::vector<double> values, double share);

}  // namespace armcmc::gap_bench
