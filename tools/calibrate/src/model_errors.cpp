#include "model_errors.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/models/registry.hpp"
#include "armcmc/models/soft_actuator.hpp"

namespace armcmc::calibrate {
namespace {

/// What a model's Predict asks of its arithmetic, for one candidate.
struct Scalar {
  using V = double;
  static V Set(double a) { return a; }
  static V Exp2(double a) { return std::exp2(a); }
  static V Fma(double a, double b, double c) { return a * b + c; }
};

template <class... Models>
double PredictBy(ModelList<Models...>, int model, const double* theta, const ModeData& data, int n) {
  using Fn = double (*)(const double*, const ModeData&, int) noexcept;
  static constexpr Fn kPredict[] = {&Models::template Predict<Scalar>...};
  return kPredict[model](theta, data, n);
}

}  // namespace

ModelErrors::ModelErrors(const EstimatorSettings& settings) : settings_(settings), model_(FindModel(settings.model)) {}

double ModelErrors::Of(const DataPack& pack, const std::array<ModeEstimate, kMaxModes>& estimates, int mode,
                       std::vector<double>* errors) {
  errors->clear();
  const auto m = static_cast<std::size_t>(mode);
  if (!estimates[m].known) return 0.0;
  std::array<double, kMaxParams> theta{};
  const int parameters = AllModels::kInfos[static_cast<std::size_t>(model_)]->num_parameters;
  for (std::size_t d = 0; d < static_cast<std::size_t>(parameters); ++d) theta[d] = estimates[m].marginal[d].ar_ap;
  if (settings_.pressure_rate) return OfPressureRate(pack, theta.data(), mode, errors);
  AllModels::kPrepare[static_cast<std::size_t>(model_)](pack, settings_.constants, mode, &data_);
  double square = 0.0;
  for (int n = 0; n < data_.num_samples; ++n) {
    const double target = data_.target[static_cast<std::size_t>(n)];
    square += target * target;
    errors->push_back(target - settings_.noise[m].mean - PredictBy(AllModels{}, model_, theta.data(), data_, n));
  }
  return data_.num_samples > 0 ? square / data_.num_samples : 0.0;
}

double ModelErrors::OfPressureRate(const DataPack& pack, const double* theta, int mode, std::vector<double>* errors) {
  double square = 0.0;
  for (int n = 0; n < pack.num_samples; ++n) {
    if (SoftActuator::ModeOf(pack, n) != mode) continue;
    const auto& u = pack.u[static_cast<std::size_t>(n)];
    const double gain = theta[0] + theta[1] * (u[2] - settings_.constants.p_atm);
    const double flow = u[static_cast<std::size_t>(mode)] * SoftActuator::Head(u[2], mode, settings_.constants);
    square += u[3] * u[3];
    errors->push_back(u[3] - settings_.noise[static_cast<std::size_t>(mode)].mean - flow / gain);
  }
  return errors->empty() ? 0.0 : square / static_cast<double>(errors->size());
}

}  // namespace armcmc::calibrate
