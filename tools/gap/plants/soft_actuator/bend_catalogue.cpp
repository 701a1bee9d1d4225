#include <algorithm>
#include <cmath>
#include <numbers>

#include "armcmc/gap/features.hpp"
#include "armcmc/gap/form_tools.hpp"
#include "armcmc/gap/sensor_forms.hpp"
#include "gap/plants/soft_actuator/actuator_equation.hpp"

namespace armcmc::gap {
namespace {

constexpr double kEdge = 0.08;  // of the recording, at each end, where an onset means nothing

EffectForm Torque(const char* effect, const char* family, const char* formula, std::vector<Coordinate> coordinates) {
  EffectForm form;
  form.effect = effect;
  form.family = family;
  form.formula = formula;
  form.slot = Slot::kForce;
  form.coordinates = std::move(coordinates);
  return form;
}

/// Acceleration that would hold the rms angle: the size of the amplitudes.
double Strength(const Signals& s, const ActuatorConstants& constants) { return constants.q3 * s.output_scale; }

void AddFriction(const Signals& s, double strength, std::vector<EffectForm>* out) {
  const double speed = s.scale_of(Role::kVelocity), angle = s.scale_of(Role::kPosition);
  const Coordinate level = AmplitudeOf("acceleration", "rad/s^2", strength, true);
  EffectForm coulomb = Torque("joint_friction", "dry friction", "alpha'' - acceleration tanh(alpha' / rate_s)",
                              {level, ShapeOf("rate_s", "rad/s", speed, 0.002, 0.5)});
  coulomb.own_groups = {"rate", "direction of motion"};
  coulomb.force = [](const Motion& m, const double* v, const double*) { return -v[0] * std::tanh(m.rate / v[1]); };
  SetStarts(&coulomb, {4});
  out->push_back(coulomb);
  EffectForm stribeck = VariantOf(coulomb, "stribeck",
                                  "alpha'' - (acceleration + excess exp(-(alpha' / rate_e)^2)) tanh(alpha' / rate_s)");
  stribeck.num_amplitudes = 2;
  stribeck.coordinates = {level, AmplitudeOf("excess", "rad/s^2", strength, true), coulomb.coordinates[1],
                          ShapeOf("rate_e", "rad/s", speed, 0.03, 1.0)};
  stribeck.force = [](const Motion& m, const double* v, const double*) {
    const double ratio = m.rate / v[3];
    return -(v[0] + v[1] * std::exp(-ratio * ratio)) * std::tanh(m.rate / v[2]);
  };
  SetStarts(&stribeck, {2, 2});
  out->push_back(stribeck);

  EffectForm wen = Torque("hysteresis", "hysteresis",
                          "alpha'' - acceleration z / reach, z' = alpha' (1 - |z| / reach while loading)",
                          {level, ShapeOf("reach", "rad", angle, 0.005, 0.6)});
  wen.own_groups = {"angle since reversal", "direction of motion"};
  wen.remember = [](const Motion& m, const double* v, double* z) {
    const double travel = m.rate * m.dt;
    const double yielding = z[0] * travel > 0.0 ? std::abs(z[0]) / v[1] : 0.0;
    z[0] = std::clamp(z[0] + travel * (1.0 - yielding), -v[1], v[1]);
  };
  wen.force = [](const Motion&, const double* v, const double* z) { return -v[0] * z[0] / v[1]; };
  SetStarts(&wen, {4});
  out->push_back(wen);
  EffectForm dahl = VariantOf(wen, "dahl", "alpha'' - acceleration z, z' = alpha' (1 - z sign(alpha')) / reach");
  dahl.remember = [](const Motion& m, const double* v, double* z) {
    const double end = m.rate > 0.0 ? 1.0 : (m.rate < 0.0 ? -1.0 : z[0]);
    z[0] = end + (z[0] - end) * std::exp(-std::abs(m.rate) * m.dt / v[1]);
  };
  dahl.force = [](const Motion&, const double* v, const double* z) { return -v[0] * z[0]; };
  out->push_back(dahl);
}

void AddStatics(const Signals& s, double strength, std::vector<EffectForm>* out) {
  const double angle = s.scale_of(Role::kPosition);
  EffectForm cubic = Torque("cubic_stiffness", "stiffening", "alpha'' - stiffness alpha^3",
                            {AmplitudeOf("stiffness", "1/(s rad)^2", strength / (angle * angle * angle), true)});
  cubic.own_groups = {"angle"};
  cubic.force = [](const Motion& m, const double* v, const double*) { return -v[0] * m.angle * m.angle * m.angle; };
  SetStarts(&cubic, {});
  out->push_back(cubic);
  EffectForm gravity = Torque("gravity_load", "gravity", "alpha'' - acceleration sin(alpha)",
                              {AmplitudeOf("acceleration", "rad/s^2", strength, true)});
  gravity.own_groups = {"angle"};
  gravity.force = [](const Motion& m, const double* v, const double*) { return -v[0] * std::sin(m.angle); };
  SetStarts(&gravity, {});
  out->push_back(gravity);
  EffectForm tilted = VariantOf(gravity, "tilted", "alpha'' - acceleration sin(alpha) - side cos(alpha)");
  tilted.num_amplitudes = 2;
  tilted.coordinates.push_back(AmplitudeOf("side", "rad/s^2", strength, false));
  tilted.force = [](const Motion& m, const double* v, const double*) {
    return -v[0] * std::sin(m.angle) - v[1] * std::cos(m.angle);
  };
  SetStarts(&tilted, {});
  out->push_back(tilted);
}

void AddPayload(const Signals& s, std::vector<EffectForm>* out) {
  EffectForm payload = Torque("payload_step", "payload", "(1 + load) alpha'' in place of alpha'' from t = at",
                              {{"load", "-", 0.0, 30.0, 0.0, 0.5, 1.0, false},
                               {"at", "s", kEdge, 1.0 - kEdge, 0.5, 0.3, s.duration, false, true}});
  payload.gates_by_time = false;
  payload.own_groups = {"acceleration", "time x acceleration"};
  const double origin = s.origin;
  payload.force = [origin](const Motion& m, const double* v, const double*) {
    // The sample in which the load comes counts by its share, so that its time has a slope.
    const double on = std::clamp((m.t - origin - v[1]) / m.dt + 1.0, 0.0, 1.0);
    return -on * v[0] / (1.0 + v[0]) * m.base;
  };
  constexpr int kTimes = 24;
  for (int i = 0; i < kTimes; ++i) payload.starts.push_back({0.0, kEdge + (1.0 - 2.0 * kEdge) * (i + 0.5) / kTimes});
  out->push_back(payload);
}

void AddPeriodic(const Signals& s, double strength, std::vector<EffectForm>* out) {
  EffectForm sine =
      Torque("periodic_disturbance", "periodic", "alpha'' + cosine cos(2 pi frequency t) + sine sin(2 pi frequency t)",
             {AmplitudeOf("cosine", "rad/s^2", strength, false),
              AmplitudeOf("sine", "rad/s^2", strength, false),
              {"frequency", "Hz", std::log(3.0 / s.duration), std::log(0.25 / s.dt), std::log(10.0), 2.0, 1.0, true}});
  sine.num_amplitudes = 2;
  sine.force = [](const Motion& m, const double* v, const double*) {
    const double phase = 2.0 * std::numbers::pi * v[2] * m.t;
    return v[0] * std::cos(phase) + v[1] * std::sin(phase);
  };
  sine.find_starts = [](const Signals& in, const Vector& residual) {
    const double frequency = std::max(StrongestLine(residual, in.dt).frequency, 3.0 / in.duration);
    return std::vector<std::vector<double>>{{0.0, 0.0, std::log(frequency)}};
  };
  out->push_back(sine);
}

void AddSensors(const Signals& s, const ActuatorConstants& constants, std::vector<EffectForm>* out) {
  EffectForm pressure = Torque("pressure_bias", "sensor zero", "p + bias: alpha'' - q1 bias on the measured pressure",
                               {AmplitudeOf("bias", "Pa", s.scale_of(Role::kPressure), false)});
  pressure.force = [q1 = constants.q1](const Motion&, const double* v, const double*) { return -q1 * v[0]; };
  SetStarts(&pressure, {});
  out->push_back(pressure);
  EffectForm angle;
  angle.effect = "angle_bias";
  angle.family = "sensor zero";
  angle.formula = "alpha + bias";
  angle.coordinates = {AmplitudeOf("bias", "rad", s.output_scale, false)};
  angle.features = [](const Signals& in, const double*) -> Matrix {
    return Vector::Constant(in.rows(), in.output_scale);
  };
  SetStarts(&angle, {});
  out->push_back(angle);
  EffectForm delay = LatencyForms(s).front();
  delay.formula = "alpha(t - time)";
  delay.own_groups = {"change of angle"};
  out->push_back(delay);
}

void AddUnlistedBend(const Signals& s, double strength, const ActuatorConstants& constants,
                     std::vector<EffectForm>* out) {
  const double speed = s.scale_of(Role::kVelocity), angle = s.scale_of(Role::kPosition);
  EffectForm wrong = UnlistedForm("constants q1, q2, q3 that are not those of this actuator", "constants",
                                  "(q1 + dq1) (p - p_atm) - (q2 + dq2) alpha' - (q3 + dq3) alpha", Slot::kForce);
  wrong.num_amplitudes = 3;
  wrong.coordinates = {AmplitudeOf("share_of_q1", "-", 1.0, false), AmplitudeOf("share_of_q2", "-", 1.0, false),
                       AmplitudeOf("share_of_q3", "-", 1.0, false)};
  // A joint without stiffness or damping runs away.
  for (Coordinate& share : wrong.coordinates) share.lower = -0.95;
  wrong.force = [constants](const Motion& m, const double* v, const double*) {
    return v[0] * m.drive - v[1] * constants.q2 * m.rate - v[2] * constants.q3 * m.angle;
  };
  SetStarts(&wrong, {});
  out->push_back(wrong);

  EffectForm drag = UnlistedForm("drag that grows with the square of the rate", "quadratic drag",
                                 "alpha'' - drag alpha' |alpha'|", Slot::kForce);
  drag.coordinates = {AmplitudeOf("drag", "1/rad", strength / (speed * speed), true)};
  drag.force = [](const Motion& m, const double* v, const double*) { return -v[0] * m.rate * std::abs(m.rate); };
  SetStarts(&drag, {});
  out->push_back(drag);

  EffectForm obstacle =
      UnlistedForm("an obstacle in the way", "obstacle", "alpha'' - stiffness max(alpha - angle, 0)", Slot::kForce);
  obstacle.coordinates = {AmplitudeOf("stiffness", "1/s^2", strength / angle, true, 0.5, 20.0),
                          {"angle", "rad", 0.05, 2.0, 0.8, 0.5, angle, false}};
  obstacle.force = [](const Motion& m, const double* v, const double*) {
    return -v[0] * std::max(m.angle - v[1], 0.0);
  };
  obstacle.starts = {{0.0, 0.4}, {0.0, 0.7}, {0.0, 1.0}, {0.0, 1.3}};
  out->push_back(obstacle);
}

}  // namespace

std::vector<EffectForm> BendCatalogue(const Signals& signals, const ActuatorConstants& constants) {
  const double strength = Strength(signals, constants);
  std::vector<EffectForm> forms;
  AddFriction(signals, strength, &forms);
  AddStatics(signals, strength, &forms);
  AddPayload(signals, &forms);
  AddPeriodic(signals, strength, &forms);
  AddSensors(signals, constants, &forms);
  AddUnlistedBend(signals, strength, constants, &forms);
  return forms;
}

}  // namespace armcmc::gap
