// What the engine asks of the actuator.

#include <cmath>
#include <memory>

#include "armcmc/models/compiled_plant.hpp"
#include "armcmc/models/plain_ops.hpp"
#include "plants/soft_actuator/bend_predictor.hpp"
#include "plants/soft_actuator/bend_watch.hpp"
#include "plants/soft_actuator/constants.hpp"
#include "plants/soft_actuator/effects.hpp"
#include "plants/soft_actuator/flow_rows.hpp"
#include "plants/soft_actuator/gap_family.hpp"
#include "plants/soft_actuator/model.hpp"

namespace armcmc {
namespace {

/// Inflow through a constant gain g: u_c sqrt(p_s - p) = g pdot.
void TypicalActuation(double t, std::size_t n, DataPack* pack) noexcept ARMCMC_NONBLOCKING {
  constexpr double kSupply = ActuatorConstants().p_supply, kAtmosphere = ActuatorConstants().p_atm, kGain = 4e-4;
  const double p = kAtmosphere + 1.0 + std::sin(5.0 * t);
  const double pdot = 5.0 * std::cos(5.0 * t);
  pack->u[n][0] = pdot > 0.0 ? kGain * pdot / std::sqrt(kSupply - p) : 0.0;
  pack->u[n][1] = pdot > 0.0 ? 0.0 : -kGain * pdot / std::sqrt(p - kAtmosphere);
  pack->u[n][2] = p;
  pack->u[n][3] = pdot;
  pack->y[n] = 0.42 * (p - kAtmosphere);
}

RatePair PressureRate(const double* theta, const DataPack& pack, int n, const PlantConstants& values) noexcept {
  const ActuatorConstants constants(values);
  const int mode = SoftActuator::ModeOf(pack, n);
  const auto& u = pack.u[static_cast<std::size_t>(n)];
  const double gain = theta[0] + theta[1] * (u[2] - constants.p_atm);
  const double flow = u[static_cast<std::size_t>(mode)] * SoftActuator::Head(u[2], mode, constants);
  return {u[3], flow / gain};
}

/// Valves that move the joint by a radian, with sensors that are not clean.
void Excite(EstimatorSettings* s) {
  s->gap_watch.tolerance = 0.1;  // the noise of the measured inputs bends the flow a little
  // While the pressure stands still, the noise of the measured pdot makes a pack prefer g = 0 by some 20 nats: that
  // is no change of the valve.
  s->forgetting.lambda_max = 1.0 - 1e-12;
  ActuatorConstants constants(s->constants);
  constants.q1 = 0.0704;  // rad/s^2 per Pa, so that tens of kPa bend it by a radian
  s->constants = constants;
  for (auto& noise : s->noise) {
    noise.std = 0.25;  // sqrt(Pa): sensor noise of 500 Pa/s on pdot times a gain of 5e-4
    noise.estimate_std = true;
  }
}

constexpr ModelVariant kVariants[] = {{"soft_actuator_excited", &Excite}};

std::unique_ptr<EffectRows> MakeFlowRows(const EstimatorSettings& settings) {
  if (settings.num_effects == 0 && !settings.regress_rate) return nullptr;
  return std::make_unique<FlowRows>(FlowPlan(settings, settings.num_parameters));
}

std::unique_ptr<OutputPredictor> MakeBendPredictor(const ModelInfo& info, const PlantConstants& constants,
                                                   const EffectRows* rows) {
  const auto* flow = static_cast<const FlowRows*>(rows);
  return std::make_unique<BendPredictor>(info, constants, flow != nullptr ? flow->plan() : FlowPlan());
}

std::unique_ptr<OutputWatch> MakeBendWatch(const EstimatorSettings& settings, double rate,
                                           const OutputPredictor& predictor) {
  return std::make_unique<BendWatch>(settings, rate, static_cast<const BendPredictor&>(predictor));
}

}  // namespace

constinit const CompiledPlant kActuatorPlant{
    .inputs = {{{"u_c", "-", ""}, {"u_d", "-", ""}, {"p", "Pa", ""}, {"pdot", "Pa/s", "p"}}},
    .output = {"alpha", "rad", ""},
    .output_word = "angle",
    .law_is_output = false,
    .no_contact_as = "an actuator has no contact",
    .constants = kActuatorConstants,
    .rate_unit = kRateUnit,
    .offline_as = "it acts on the bending angle ({}), and the estimator estimates the valve flow",
    .effects = ActuatorEffects::kInfos,
    .variants = kVariants,
    .prepare = &SoftActuator::Prepare,
    .predict = &SoftActuator::Predict<PlainOps>,
    .rate = &PressureRate,
    .typical_sample = &TypicalActuation,
    .make_rows = &MakeFlowRows,
    .make_predictor = &MakeBendPredictor,
    .make_watch = &MakeBendWatch,
    .gap_family = &ActuatorGapFamily,
    .regression = nullptr,
};

}  // namespace armcmc
