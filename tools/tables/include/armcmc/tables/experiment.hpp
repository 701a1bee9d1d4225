#pragma once

#include <functional>
#include <string>
#include <vector>

#include "armcmc/tables/score.hpp"

namespace armcmc::tables {

/// One line of a table, means over the seeds.
struct Row {
  std::string key, label;
  bool online = true, has_intervals = true;
  ContactScore contact;
  ActuatorScore actuator;
  /// Standard error of contact.coverage: the larger of what right intervals would have (NullCoverageVariance) and of
  /// what the runs differ by.
  std::array<std::array<double, 3>, 3> coverage_error{};
};

/// A recording, or the mean over several with other noise, estimated by every method.
struct Experiment {
  std::string key;  ///< In tables.json: see PaperPlant::key().
  std::string title;
  PlantNumber plant = PlantNumber::kNone;
  int seeds = 1;
  std::vector<Row> rows;
  Recording recording;                      ///< The first seed's.
  std::vector<EstimatorSettings> settings;  ///< Of each trace.
  std::vector<Trace> traces;                ///< The first seed's.
  [[nodiscard]] const Row& Find(const std::string& key) const;
};

/// Where recordings come from: number of the seed in [0, seeds) to recording.
using Source = std::function<Recording(int)>;

/// Runs every method on every recording. ARMCMC gives two rows, armcmc_ap and armcmc_map.
[[nodiscard]] Experiment RunExperiment(const std::string& key, const std::string& title, int seeds,
                                       const Source& source, const std::vector<MethodSpec>& methods);

/// Coverage of ARMCMC's intervals when the estimator assumes another noise law than the true one.
struct LikelihoodCell {
  std::string noise, assumed;
  int seeds = 1;
  Row row;
};
/// Which noise laws the estimator assumes.
enum class AssumedLaws {
  kOwn,  ///< That of the noise: four cells.
  kAll,  ///< Each of the four under each: sixteen.
};
/// @param source  Scenario and number of the seed in [0, seeds) to recording.
/// @param done    Called after each cell.
[[nodiscard]] std::vector<LikelihoodCell> RunLikelihoods(
    int seeds, AssumedLaws which, const std::function<Recording(const std::string&, int)>& source,
    const std::function<void()>& done);

}  // namespace armcmc::tables
