#pragma once

#include <cstdint>
#include <ostream>
#include <string>

#include "armcmc/estimate.hpp"
#include "armcmc/estimator.hpp"

namespace armcmc::replay {

/// Writes estimates as CSV, one row a pack, numbers with 17 significant digits: equal text is equal bits.
///
/// Columns: pack, t, mode; for each quantity NAME (AR-MAP), NAME_ap (AR-AP), NAME_sd, NAME_q025, NAME_q25, NAME_q50,
/// NAME_q75, NAME_q975, NAME_chain_mean; lambda .. y_rmse of the mode that is reported; p_drifted, the probability
/// that its parameters drift, and for each quantity NAME_drift_per_s, the expected rate; for plants with several modes
/// also NAME_MODE and NAME_MODE_sd and draws_MODE for each mode. A pack without information about a parameter
/// repeats what is known; what is not known is an empty field, as is a figure of a step that was not made. The zeta of
/// the first pack is inf.
class EstimateCsv {
 public:
  /// Writes the header. @param estimator  Gives the names; must outlive this. @param out  Must outlive this.
  EstimateCsv(const Estimator& estimator, std::ostream* out);
  void Write(const Estimate& estimate);

 private:
  void Number(double value);
  void NumberIf(bool condition, double value);
  void Text(std::string_view text);
  void EndRow();

  const Estimator& estimator_;
  std::ostream* out_;
  std::string row_;
};

}  // namespace armcmc::replay
