#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "armcmc/tables/experiment.hpp"

namespace armcmc::tables {

/// Everything that one run of armcmc-tables found.
struct Result {
  std::string contact_data, actuator_data;  ///< "the authors' recording" or "the plant's own scenario".
  std::vector<Experiment> experiments;
  std::vector<LikelihoodCell> likelihoods;
  bool baselines = true;  ///< They were run, too.
  [[nodiscard]] const Experiment* Find(const std::string& key) const;
};

/// A number of the paper's tables, and what the authors' stored traces hold in its place; NaN where there is none.
struct PaperRow {
  std::string key, label;
  std::vector<double> values;
};
/// Parameter MAEs of K, B, p and the column "F_e (mN)" of the paper's table.
[[nodiscard]] const std::vector<PaperRow>& PublishedContact();
/// From the authors' stored results: MAE of K, B, p active and in contact, clean force MAE in contact and overall in
/// mN, and the L2 norm against the noisy force in N.
[[nodiscard]] const std::vector<PaperRow>& StoredContact();
/// theta1, theta2 (1e-6) and alpha L2 norms.
[[nodiscard]] const std::vector<PaperRow>& PublishedActuator();
/// The same, and the relative flow error.
[[nodiscard]] const std::vector<PaperRow>& StoredActuator();
[[nodiscard]] const char* ContactNote();
[[nodiscard]] const char* ActuatorNote();

[[nodiscard]] nlohmann::ordered_json ToJson(const Result& result);
/// The tables as text for a terminal.
[[nodiscard]] std::string ToText(const Result& result);
/// One page with tables and figures that opens without a network.
[[nodiscard]] std::string ToHtml(const Result& result);

/// Which intervals of a contact row cover as stated, and which do not.
[[nodiscard]] std::string CoverageSentence(const Row& row);

/// Rows that an online baseline wins against AR-MAP, "PLANT: alpha_l2: rls_per_mode 0.1 < 0.2".
[[nodiscard]] std::vector<std::string> LostRows(const Result& result);
/// Why the rows of the actuator are lost.
[[nodiscard]] const char* LostRowsNote();

}  // namespace armcmc::tables
