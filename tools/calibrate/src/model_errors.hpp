#pragma once

#include <array>
#include <vector>

#include "armcmc/data_pack.hpp"
#include "armcmc/estimate.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/model.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::calibrate {

/// Errors of a pack in the unit of the regression target under given estimates.
class ModelErrors {
 public:
  /// @pre no effects.
  explicit ModelErrors(const EstimatorSettings& settings);

  /// Target minus prediction with the mean of the draws, of every sample of a mode that is known; the noise's mean is
  /// taken off.
  /// @return Mean square of the target; 0 without samples.
  double Of(const DataPack& pack, const std::array<ModeEstimate, kMaxModes>& estimates, int mode,
            std::vector<double>* errors);

 private:
  /// The same where the pressure rate is what is regressed.
  double OfRate(const DataPack& pack, const double* theta, int mode, std::vector<double>* errors);

  EstimatorSettings settings_;
  const ModelInfo& model_;
  ModeData data_;
};

}  // namespace armcmc::calibrate
