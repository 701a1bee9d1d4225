#include "model_errors.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/models/registry.hpp"

namespace armcmc::calibrate {
ModelErrors::ModelErrors(const EstimatorSettings& settings)
    : settings_(settings), model_(*CompiledModels()[static_cast<std::size_t>(FindModel(settings.model))]) {}

double ModelErrors::Of(const DataPack& pack, const std::array<ModeEstimate, kMaxModes>& estimates, int mode,
                       std::vector<double>* errors) {
  errors->clear();
  const auto m = static_cast<std::size_t>(mode);
  if (!estimates[m].known) return 0.0;
  std::array<double, kMaxParams> theta{};
  for (std::size_t d = 0; d < static_cast<std::size_t>(model_.num_parameters); ++d)
    theta[d] = estimates[m].marginal[d].ar_ap;
  if (settings_.regress_rate) return OfRate(pack, theta.data(), mode, errors);
  model_.compiled->prepare(pack, settings_.constants, mode, &data_);
  double square = 0.0;
  for (int n = 0; n < data_.num_samples; ++n) {
    const double target = data_.target[static_cast<std::size_t>(n)];
    square += target * target;
    errors->push_back(target - settings_.noise[m].mean - model_.compiled->predict(theta.data(), data_, n));
  }
  return data_.num_samples > 0 ? square / data_.num_samples : 0.0;
}

double ModelErrors::OfRate(const DataPack& pack, const double* theta, int mode, std::vector<double>* errors) {
  double square = 0.0;
  for (int n = 0; n < pack.num_samples; ++n) {
    if (model_.mode_of(pack, n) != mode) continue;
    const RatePair rate = model_.compiled->rate(theta, pack, n, settings_.constants);
    square += rate.measured * rate.measured;
    errors->push_back(rate.measured - settings_.noise[static_cast<std::size_t>(mode)].mean - rate.predicted);
  }
  return errors->empty() ? 0.0 : square / static_cast<double>(errors->size());
}

}  // namespace armcmc::calibrate
