#pragma once

#include <functional>
#include <string>
#include <vector>

#include "armcmc/replay/pack_source.hpp"
#include "armcmc/replay/replay.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::compare {

/// One quantity of one mode over time, where it was updated.
struct QuantityTrace {
  std::string name, unit, mode;
  std::vector<double> t, ar_map, q025, q975;
  double last = 0.0, last_sd = 0.0, last_q025 = 0.0, last_q975 = 0.0;
};

/// Everything that one run shows of itself.
struct RunTrace {
  std::string label;  ///< For the reader.
  EstimatorSettings settings;
  std::string output_name, output_unit;
  std::vector<QuantityTrace> quantities;
  // Of every pack. What a pack did not update is NaN.
  std::vector<double> t, log_evidence, zeta, zeta_threshold, lambda, draws, k_min, ess, compute_ms;
  std::vector<double> modifications_t;  ///< Times of packs that were taken for a change.
  // Of every sample.
  std::vector<double> sample_t, residual;  ///< Measured minus predicted with the estimates on display; NaN: none.
  replay::ReplaySummary summary;

  [[nodiscard]] double residual_rms() const;  ///< Over the samples that have one.
  [[nodiscard]] double total_log_evidence() const;
};

/// Runs the estimator of `settings` over the packs of `source` and keeps what it says.
[[nodiscard]] RunTrace TraceRun(const EstimatorSettings& settings, replay::PackSource* source, std::string label,
                                const std::function<void(double)>& on_progress);

/// A setting in which two configurations differ.
struct SettingDifference {
  std::string key, a, b;
};
/// By key, as in a configuration; empty: both compute the same.
[[nodiscard]] std::vector<SettingDifference> DifferencesOf(const EstimatorSettings& a, const EstimatorSettings& b);

}  // namespace armcmc::compare
