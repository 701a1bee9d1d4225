#pragma once

#include <cstdint>
#include <string>

#include "armcmc/estimator_status_t.hpp"
#include "armcmc/plant_sim/latency_histogram.hpp"
#include "armcmc/plant_sim/scenario.hpp"
#include "armcmc/plant_sim/scorer.hpp"
#include "plant_options.hpp"

namespace armcmc::plant_sim {

/// What a live run found out.
struct LiveResult {
  std::int64_t run_id = 0;
  std::int64_t packs_planned = 0, packs_sent = 0, packs_answered = 0, packs_late = 0;
  std::int64_t send_errors = 0, log_lost = 0;
  bool interrupted = false;
  LatencyHistogram lateness;           ///< Of the plant's own sending.
  LatencyHistogram estimate_latency;   ///< Last sample of the pack to arrival of its estimate.
  std::int64_t estimates_foreign = 0;  ///< For another run of a plant.
  std::int64_t estimates_undecodable = 0;
  std::int64_t silences = 0, returns = 0;
  bool status_seen = false;
  estimator_status_t status{};  ///< The last one.
};

/// The table for people.
[[nodiscard]] std::string FormatTable(const Scenario& scenario, const LiveResult& result, const Scorer& scorer);
/// The report for programs. @throws std::runtime_error when the file cannot be written.
void WriteReport(const Scenario& scenario, const PlantOptions& options, const LiveResult& result, const Scorer& scorer);

}  // namespace armcmc::plant_sim
