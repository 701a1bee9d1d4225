#include "soft_actuator/plant.hpp"

#include <cmath>
#include <stdexcept>

#include "armcmc/data_pack_t.hpp"
#include "armcmc/plant_sim/effects/hidden_effect.hpp"
#include "armcmc/plant_sim/solver.hpp"
#include "soft_actuator/effects.hpp"

namespace armcmc::plant_sim {
namespace {

enum ActuatorParameter { kTheta1Fill = 0, kTheta2Fill = 1, kTheta1Vent = 2, kTheta2Vent = 3 };

constexpr double kPressureRange = 1e5, kOpeningRange = 0.1;  // Pa, of which a LawError's waves are no shorter

double SignedRoot(double difference) noexcept { return std::copysign(std::sqrt(std::abs(difference)), difference); }

const std::vector<EffectSpec>& AllActuatorEffects() {
  static const std::vector<EffectSpec> effects = ActuatorEffects();
  return effects;
}

std::unique_ptr<Plant> MakeSoftActuator(const PlantSetup& setup) { return std::make_unique<SoftActuatorPlant>(setup); }

}  // namespace

SoftActuatorPlant::SoftActuatorPlant(const PlantSetup& setup)
    : schedule_(setup.schedule),
      p_atm_(setup.options.Number("p_atm")),
      p_supply_(setup.options.Number("p_supply")),
      q1_(setup.options.Number("q1")),
      q2_(setup.options.Number("q2")),
      q3_(setup.options.Number("q3")),
      dt_(setup.sample_interval_s),
      substeps_(NumSubsteps(setup.sample_interval_s, setup.options.Number("max_step_s"))),
      error_(setup.options.Number("error"), setup.seed),
      controller_(MakeValveController(setup.options, p_atm_, setup.sample_interval_s)) {
  if (!(p_supply_ > p_atm_)) throw std::invalid_argument("constants.p_supply must be above constants.p_atm");
  if (!(Truth(kFill, 0.0)[0] > 0.0))
    throw std::invalid_argument("theta1_c + theta2_c p_atm must be positive: an open fill valve raises the pressure");
  if (!(Truth(kVent, 0.0)[0] < 0.0))
    throw std::invalid_argument("theta1_d + theta2_d p_atm must be negative: an open vent valve lowers the pressure");
}

double SoftActuatorPlant::Flow(const ValveOpening& valve, double gauge_pressure) const noexcept {
  return Mode(valve) == kFill ? valve.fill * SignedRoot(p_supply_ - p_atm_ - gauge_pressure)
                              : valve.vent * SignedRoot(gauge_pressure);
}

double SoftActuatorPlant::PressureRate(const ValveOpening& valve, double gauge_pressure, double t_s) const noexcept {
  const Theta theta = Truth(Mode(valve), t_s);
  double flow = Flow(valve, gauge_pressure);
  if (Mode(valve) == kFill && !hidden_.empty()) {
    double supply = p_supply_;
    for (const Hidden& hidden : hidden_)
      if (Acts(hidden, t_s)) supply = hidden.effect->Supply(supply, valve.fill);
    if (supply != p_supply_) flow = valve.fill * SignedRoot(supply - p_atm_ - gauge_pressure);
  }
  const double opening = valve.fill - valve.vent;
  return flow / (theta[0] + theta[1] * gauge_pressure) *
         error_.Factor(gauge_pressure / kPressureRange, opening / kOpeningRange);
}

void SoftActuatorPlant::Hide(const std::vector<HiddenEffect>& effects, const EffectTiming& timing) {
  for (const HiddenEffect& effect : effects)
    if (effect.spec->make_inner != nullptr)
      hidden_.push_back({effect.gate, std::unique_ptr<ActuatorEffect>(static_cast<ActuatorEffect*>(
                                          effect.spec->make_inner(effect.values, timing).release()))});
}

bool SoftActuatorPlant::Acts(const Hidden& hidden, double t_s) noexcept {
  PlantSample at;
  at.t_s = t_s;
  return hidden.gate.Open(at);
}

SoftActuatorPlant::State SoftActuatorPlant::HiddenDerivative(double t_s, const State& state,
                                                             const State& base) const noexcept {
  const ActuatorState here{t_s, state[0], state[1], state[2]};
  State added = State::Zero();
  for (const Hidden& hidden : hidden_) {
    if (!Acts(hidden, t_s)) continue;
    added[1] += hidden.effect->Bend(here, base[1]);
    added[2] += hidden.effect->PressureRate(here);
  }
  return added;
}

ValveOpening SoftActuatorPlant::StepHidden(double t_s, const ValveOpening& command) noexcept {
  ValveOpening valve = command;
  for (const Hidden& hidden : hidden_) {
    hidden.effect->Step({t_s, state_[0], state_[1], state_[2]});
    const ValveOpening stands = hidden.effect->Valve(valve);
    if (Acts(hidden, t_s)) valve = stands;
  }
  return valve;
}

void SoftActuatorPlant::Advance(PlantSample* sample) noexcept {
  if (k_ >= 0) {
    // Openings and parameters are those of the last sample until this one.
    const double t = static_cast<double>(k_) * dt_;
    const double h = dt_ / substeps_;
    const auto derivative = [this, t](double at, const State& y) -> State {
      const State base(y[1], q1_ * y[2] - q2_ * y[1] - q3_ * y[0], PressureRate(valve_, y[2], t));
      return hidden_.empty() ? base : State(base + HiddenDerivative(at, y, base));
    };
    last_angle_ = state_[0];
    for (int i = 0; i < substeps_; ++i) state_ = BogackiShampineStep(derivative, t + i * h, state_, h);
  }
  ++k_;
  const double t = static_cast<double>(k_) * dt_;
  const ValveOpening command = controller_->Step({t, p_atm_ + state_[2], last_angle_, last_pdot_});
  valve_ = StepHidden(t, command);
  last_pdot_ = PressureRate(valve_, state_[2], t);
  if (!hidden_.empty()) last_pdot_ += HiddenDerivative(t, state_, State::Zero())[2];
  sample->t_s = t;
  sample->mode = Mode(command);
  sample->inputs = {command.fill, command.vent, p_atm_ + state_[2], last_pdot_};
  sample->output = state_[0];
}

Theta SoftActuatorPlant::Truth(int mode, double t_s) const noexcept {
  const int theta1 = mode == kFill ? kTheta1Fill : kTheta1Vent;
  const int theta2 = mode == kFill ? kTheta2Fill : kTheta2Vent;
  const double slope = schedule_.Value(theta2, t_s);
  return {schedule_.Value(theta1, t_s) + slope * p_atm_, slope};
}

double SoftActuatorPlant::Predict(const Theta& theta, const PlantSample& sample) const noexcept {
  return sample.inputs[kPressureRate] * (theta[0] + theta[1] * (sample.inputs[kPressure] - p_atm_));
}

double SoftActuatorPlant::Target(const PlantSample& sample) const noexcept {
  return Flow({sample.inputs[kUc], sample.inputs[kUd]}, sample.inputs[kPressure] - p_atm_);
}

const PlantFamily& SoftActuatorFamily() {
  static const PlantFamily family = [] {
    PlantFamily f;
    f.name = "soft_actuator";
    f.kind = data_pack_t::PLANT_SOFT_ACTUATOR;
    f.inputs = {{"u_c", "-"}, {"u_d", "-"}, {"p", "Pa"}, {"pdot", "Pa/s"}};
    f.output = {"alpha", "rad"};
    f.parameters = {{"theta1_c", "sqrt(Pa) s/Pa", -1.0, 1.0},
                    {"theta2_c", "sqrt(Pa) s/Pa^2", -1e-3, 1e-3},
                    {"theta1_d", "sqrt(Pa) s/Pa", -1.0, 1.0},
                    {"theta2_d", "sqrt(Pa) s/Pa^2", -1e-3, 1e-3}};
    f.options = ValveControllerOptions();
    for (const OptionSpec& spec : {OptionSpec::Number("constants", "p_atm", 101'325.0, 1e3, 1e6),
                                   OptionSpec::Number("constants", "p_supply", 800e3, 1e3, 1e8),
                                   OptionSpec::Number("constants", "q1", 1408.5, 0.0, 1e6),
                                   OptionSpec::Number("constants", "q2", 132.28, 0.0, 1e6),
                                   OptionSpec::Number("constants", "q3", 3319.4, 0.0, 1e9),
                                   OptionSpec::Number("constants", "max_step_s", 1e-3, 1e-6, 1.0)})
      f.options.push_back(spec);
    f.options.push_back(LawErrorOption());
    f.modes = {"u_c", "u_d"};
    f.truth_names = {"g", "theta2"};
    f.target = {"flow", "clean_flow_mae", 1.0, "noisy_flow_l2"};
    f.make = MakeSoftActuator;
    f.effects = AllActuatorEffects;
    f.make_gap_meter = MakeActuatorGapMeter;
    f.model_form = ActuatorModelForm;
    return f;
  }();
  return family;
}

}  // namespace armcmc::plant_sim
