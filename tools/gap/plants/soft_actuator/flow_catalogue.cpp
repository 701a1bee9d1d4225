#include <algorithm>
#include <cmath>

#include "armcmc/gap/features.hpp"
#include "armcmc/gap/form_tools.hpp"
#include "armcmc/gap/sensor_forms.hpp"
#include "armcmc/gap/smoothing.hpp"
#include "armcmc/scalar_ops.hpp"
#include "gap/plants/soft_actuator/actuator_equation.hpp"
#include "gap/plants/soft_actuator/actuator_signals.hpp"
#include "plants/soft_actuator/effects.hpp"

namespace armcmc::gap {
namespace {

const Vector& Opening(const Signals& s) { return s.at(Role::kOpening); }

/// An effect that the estimator runs, too: its formulas are those of core.
template <class E>
EffectForm FlowFromCore() {
  EffectForm form;
  form.effect = E::kInfo.name;
  form.family = E::kInfo.family;
  form.formula = E::kInfo.formula;
  return form;
}

/// What moves the spool from where its command stands.
Vector Behind(const Vector& opening, double tau, double dt) {
  const ValveLag::Spool<ScalarOps> law(tau, dt);
  Vector behind(opening.size());
  double position = opening[0];
  for (Eigen::Index i = 0; i < opening.size(); ++i) {
    position = law.Next(position, opening[i]);
    behind[i] = position - opening[i];
  }
  return behind;
}

void AddLeak(const Signals& s, std::vector<EffectForm>* out) {
  const double pressure = s.scale_of(Role::kPressure);
  EffectForm leak = FlowFromCore<Leak>();
  leak.coordinates = {AmplitudeOf("rate", "1/s", s.output_scale / pressure, true)};
  leak.own_groups = {"pressure"};
  leak.features = [pressure](const Signals& in, const double*) -> Matrix {
    return in.at(Role::kPressure).unaryExpr([unit = in.output_scale / pressure](double gauge) {
      FlowPoint<ScalarOps> point{0.0, gauge, 0.0, 0.0};
      Leak::Apply<ScalarOps>(unit, &point);
      return point.rate;
    });
  };
  SetStarts(&leak, {});
  out->push_back(leak);
  EffectForm orifice = VariantOf(leak, "orifice", "p' - rate sign(p - p_atm) sqrt|p - p_atm|");
  orifice.coordinates = {AmplitudeOf("rate", "sqrt(Pa)/s", s.output_scale / std::sqrt(pressure), true)};
  orifice.features = [pressure](const Signals& in, const double*) -> Matrix {
    const Eigen::ArrayXd share = in.at(Role::kPressure).array() / pressure;
    return -in.output_scale * (share.sign() * share.abs().sqrt()).matrix();
  };
  out->push_back(orifice);
}

void AddDeadBand(const Signals& s, std::vector<EffectForm>* out) {
  const double opening = s.scale_of(Role::kOpening);
  EffectForm band = FlowFromCore<ValveDeadBand>();
  band.slot = Slot::kDrive;
  band.num_amplitudes = 0;
  band.linear = false;
  band.coordinates = {ShapeOf("width", "-", opening, 1e-6, 1.5)};
  band.own_groups = {"opening"};
  band.features = [band](const Signals& in, const double* shape) -> Matrix {
    return Opening(in).unaryExpr(
        [width = ShapeValue(band, 0, shape)](double u) { return ValveDeadBand::Opening<ScalarOps>(u, width) - u; });
  };
  SetStarts(&band, {10});
  out->push_back(band);
  EffectForm plain = VariantOf(band, "plain", "u = max(u - width, 0)");
  plain.features = [plain](const Signals& in, const double* shape) -> Matrix {
    return Opening(in).unaryExpr(
        [width = ShapeValue(plain, 0, shape)](double u) { return ValveDeadBand::Beyond<ScalarOps>(u, width) - u; });
  };
  out->push_back(plain);
}

void AddLag(const Signals& s, std::vector<EffectForm>* out) {
  EffectForm lag = FlowFromCore<ValveLag>();
  lag.slot = Slot::kDrive;
  lag.num_amplitudes = 0;
  lag.linear = false;
  lag.coordinates = {ShapeOf("tau", "s", s.dt, 0.1, 300.0)};
  lag.own_groups = {"change of opening", "change of the rate"};
  lag.features = [lag](const Signals& in, const double* shape) -> Matrix {
    return Behind(Opening(in), ShapeValue(lag, 0, shape), in.dt);
  };
  // Below a sample the effect goes with exp(-dt / tau): a step of Newton's from afar misses it.
  SetStarts(&lag, {24});
  out->push_back(lag);
  EffectForm second = VariantOf(lag, "second_order", "s, (tau d/dt + 1)^2 s = u_c - u_d");
  second.features = [second](const Signals& in, const double* shape) -> Matrix {
    const double samples = ShapeValue(second, 0, shape) / in.dt;
    return Leaky(Leaky(Opening(in), samples), samples) - Opening(in);
  };
  out->push_back(second);
  EffectForm late = VariantOf(lag, "dead_time", "u(t - tau)");
  late.features = [late](const Signals& in, const double* shape) -> Matrix {
    const double samples = ShapeValue(late, 0, shape) / in.dt;
    const auto whole = static_cast<Eigen::Index>(samples);
    const double part = samples - static_cast<double>(whole);
    const Vector& u = Opening(in);
    Vector delayed(u.size());
    for (Eigen::Index i = 0; i < u.size(); ++i)
      delayed[i] =
          (1.0 - part) * u[std::max<Eigen::Index>(i - whole, 0)] + part * u[std::max<Eigen::Index>(i - whole - 1, 0)];
    return delayed - u;
  };
  out->push_back(late);
}

/// The opening that passes at full supply what the valve passes at a supply lower by `droop`, less the opening.
Vector Drooped(const Signals& s, const Vector& droop, const ActuatorConstants& constants) {
  Vector less = Vector::Zero(s.rows());
  for (Eigen::Index i = 0; i < s.rows(); ++i) {
    const double u = Opening(s)[i];
    if (!(u > 0.0)) continue;
    const double head = constants.p_supply - constants.p_atm - s.at(Role::kPressure)[i];
    const double left = head - droop[i];
    less[i] = u * (std::copysign(std::sqrt(std::abs(left)), left) / std::sqrt(std::max(head, 1.0)) - 1.0);
  }
  return less;
}

void AddDroop(const Signals& s, const ActuatorConstants& constants, std::vector<EffectForm>* out) {
  const double supply = constants.p_supply - constants.p_atm, opening = s.scale_of(Role::kOpening);
  EffectForm droop = FlowFromCore<SupplyDroop>();
  droop.slot = Slot::kDrive;
  droop.num_amplitudes = 0;
  droop.linear = false;
  droop.coordinates = {{"droop", "Pa", 0.0, 1.0, 0.0, 0.2, supply / opening, false}};
  droop.starts = {{0.003}, {0.03}, {0.2}};
  droop.own_groups = {"opening", "pressure while filling", "pressure x rate"};
  droop.features = [droop, constants](const Signals& in, const double* shape) -> Matrix {
    return Drooped(in, Opening(in).unaryExpr([by = ShapeValue(droop, 0, shape)](double u) {
      return -SupplyDroop::Supply<ScalarOps>(0.0, by, u);
    }),
                   constants);
  };
  out->push_back(droop);
  EffectForm flow = VariantOf(droop, "flow", "p_s - droop u_c sqrt(p_s - p) in place of p_s");
  flow.coordinates = {{"droop", "sqrt(Pa)", 0.0, 1.0, 0.0, 0.2, std::sqrt(supply) / opening, false}};
  flow.features = [flow, constants, supply](const Signals& in, const double* shape) -> Matrix {
    const Vector head = (supply - in.at(Role::kPressure).array()).max(0.0).sqrt();
    return Drooped(in, ShapeValue(flow, 0, shape) * Opening(in).cwiseMax(0.0).cwiseProduct(head), constants);
  };
  out->push_back(flow);
  EffectForm recovery = VariantOf(droop, "recovery", "p_s - droop w in place of p_s, tau w' + w = u_c");
  recovery.coordinates.push_back(ShapeOf("tau", "s", s.dt, 3.0, 2000.0));
  recovery.starts = {{0.03, std::log(10.0)}, {0.03, std::log(100.0)}, {0.03, std::log(700.0)}};
  recovery.features = [recovery, constants](const Signals& in, const double* shape) -> Matrix {
    const double samples = ShapeValue(recovery, 1, shape) / in.dt;
    return Drooped(in, ShapeValue(recovery, 0, shape) * Leaky(Opening(in).cwiseMax(0.0), samples), constants);
  };
  out->push_back(recovery);
}

void AddPressureBias(const Signals& s, std::vector<EffectForm>* out) {
  EffectForm bias = FlowFromCore<PressureBias>();
  bias.slot = Slot::kInputMap;
  bias.coordinates = {AmplitudeOf("bias", "Pa", s.scale_of(Role::kPressure), false, 0.2, 0.8)};
  bias.own_groups = {"pressure", "pressure x rate"};
  bias.features = [](const Signals& in, const double*) -> Matrix {
    return Vector::Constant(in.rows(), in.scale_of(Role::kPressure));
  };
  bias.linear = false;
  bias.starts = {{-0.1}, {-0.01}, {0.01}, {0.1}};
  out->push_back(bias);
}

void AddUnlistedFlow(const Signals& s, std::vector<EffectForm>* out) {
  EffectForm zero =
      UnlistedForm("an offset of the pressure-rate sensor", "rate sensor zero", "p' + offset", Slot::kAdditive);
  zero.coordinates = {AmplitudeOf("offset", "Pa/s", s.output_scale, false)};
  zero.features = [](const Signals& in, const double*) -> Matrix {
    return Vector::Constant(in.rows(), in.output_scale);
  };
  SetStarts(&zero, {});
  out->push_back(zero);

  EffectForm tube = LatencyForms(s)[1];
  tube.listed = false;
  tube.effect = "a lag of the pressure-rate sensor";
  tube.family = "tube";
  out->push_back(tube);

  EffectForm play = UnlistedForm("play of a valve", "valve play", "u = play(u, width)", Slot::kDrive);
  play.num_amplitudes = 0;
  play.linear = false;
  play.coordinates = {ShapeOf("width", "-", s.scale_of(Role::kOpening), 1e-4, 1.0)};
  play.features = [play](const Signals& in, const double* shape) -> Matrix {
    const double half = 0.5 * ShapeValue(play, 0, shape);
    Vector out_of(in.rows());
    double at = Opening(in)[0];
    for (Eigen::Index i = 0; i < in.rows(); ++i) {
      at = std::clamp(at, Opening(in)[i] - half, Opening(in)[i] + half);
      out_of[i] = at - Opening(in)[i];
    }
    return out_of;
  };
  SetStarts(&play, {5});
  out->push_back(play);

  EffectForm sine =
      UnlistedForm("a periodic pressure rate", "periodic", "p' + cosine cos + sine sin of frequency", Slot::kAdditive);
  sine.num_amplitudes = 2;
  sine.coordinates = {
      AmplitudeOf("cosine", "Pa/s", s.output_scale, false),
      AmplitudeOf("sine", "Pa/s", s.output_scale, false),
      {"frequency", "Hz", std::log(3.0 / s.duration), std::log(0.25 / s.dt), std::log(10.0), 2.0, 1.0, true}};
  sine.features = [sine](const Signals& in, const double* shape) -> Matrix {
    return in.output_scale * Waves(in.t, ShapeValue(sine, 0, shape), 1, 1);
  };
  sine.find_starts = [](const Signals& in, const Vector& residual) {
    const double frequency = std::max(StrongestLine(residual, in.dt).frequency, 3.0 / in.duration);
    return std::vector<std::vector<double>>{{0.0, 0.0, std::log(frequency)}};
  };
  out->push_back(sine);
}

}  // namespace

std::vector<EffectForm> FlowCatalogue(const Signals& signals, const ActuatorConstants& constants) {
  std::vector<EffectForm> forms;
  AddLeak(signals, &forms);
  AddDeadBand(signals, &forms);
  AddLag(signals, &forms);
  AddDroop(signals, constants, &forms);
  AddPressureBias(signals, &forms);
  AddUnlistedFlow(signals, &forms);
  return forms;
}

}  // namespace armcmc::gap
