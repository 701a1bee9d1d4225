#include <algorithm>
#include <cmath>
#include <vector>

#include "armcmc/gap/features.hpp"
#include "armcmc/gap/sensor_forms.hpp"
#include "gap/plants/hunt_crossley/contact_equation.hpp"
#include "gap/plants/hunt_crossley/contact_forms.hpp"

namespace armcmc::gap {
namespace {

Vector Scaled(const Vector& series, double scale) { return series * scale; }

void AddSensorZero(const Signals& s, std::vector<EffectForm>* out) {
  const double force = s.output_scale;
  EffectForm bias = FromCore("force_bias", {AmplitudeOf("force", "N", force, false)});
  SetStarts(&bias, {});
  bias.own_groups = {"time"};
  bias.plain_error = "a zero of the force that is off";
  out->push_back(bias);
  EffectForm drift = FromCore("force_drift", {AmplitudeOf("rate", "N/s", force / s.duration, false),
                                              {"origin", "s", 0.0, 0.0, 0.0, 1.0, 1.0, false}});
  // The origin is the start of the recording: a constant in addition to the drift is another effect.
  drift.coordinates.pop_back();
  drift.features = [](const Signals& in, const double*) -> Matrix { return in.output_scale * in.Elapsed(); };
  SetStarts(&drift, {});
  drift.own_groups = {"time"};
  drift.plain_error = "a zero of the force that drifts";
  out->push_back(drift);
  EffectForm exponential = Reformulated(
      drift, "exponential", "f + force (1 - exp(-t / time_constant))",
      {AmplitudeOf("force", "N", force, false), DownTo(ShapeOf("time_constant", "s", s.duration, 0.05, 1.5))}, 1);
  exponential.features = [exponential](const Signals& in, const double* shape) -> Matrix {
    const double tau = ShapeValue(exponential, 0, shape);
    return in.output_scale * (1.0 - Exp((in.origin - in.t.array()) / tau).array()).matrix();
  };
  SetStarts(&exponential, {3});
  out->push_back(exponential);
}

void AddDryFriction(const Signals& s, std::vector<EffectForm>* out) {
  const double force = s.output_scale, speed = s.scale_of(Role::kVelocity), length = s.scale_of(Role::kPosition);
  const Coordinate level = AmplitudeOf("force", "N", force, true);
  const Coordinate width = UpTo(ShapeOf("speed", "m/s", speed, 0.003, 0.4));
  const Coordinate distance = UpTo(ShapeOf("distance", "m", length, 0.003, 0.6));
  const Coordinate stribeck_speed = ShapeOf("stribeck_speed", "m/s", speed, 0.03, 1.0);
  EffectForm coulomb = FromCore("coulomb_friction", {level, width});
  coulomb.features = [coulomb](const Signals& in, const double* shape) -> Matrix {
    return coulomb.coordinates[0].unit_size * Tanh(in.at(Role::kVelocity) / ShapeValue(coulomb, 0, shape));
  };
  coulomb.gates_by_mode = true;
  coulomb.own_groups = {"speed", "direction of motion", "distance since reversal"};
  SetStarts(&coulomb, {5});
  out->push_back(coulomb);

  EffectForm stribeck =
      Reformulated(coulomb, "stribeck", "f + (force + excess exp(-(v / stribeck_speed)^2)) tanh(v / speed)",
                   {level, AmplitudeOf("excess", "N", force, true), width, stribeck_speed}, 2);
  stribeck.features = [stribeck](const Signals& in, const double* shape) -> Matrix {
    const Vector& v = in.at(Role::kVelocity);
    Matrix columns(in.rows(), 2);
    columns.col(0) = in.output_scale * Tanh(v / ShapeValue(stribeck, 0, shape));
    columns.col(1) = columns.col(0).cwiseProduct(Exp(-(v / ShapeValue(stribeck, 1, shape)).cwiseAbs2()));
    return columns;
  };
  SetStarts(&stribeck, {3, 3});
  out->push_back(stribeck);

  EffectForm dahl = FromCore("presliding_friction", {level, distance});
  dahl.features = [dahl](const Signals& in, const double* shape) -> Matrix {
    const Vector& v = in.at(Role::kVelocity);
    Vector column = Exp(v.cwiseAbs() * (-in.dt / ShapeValue(dahl, 0, shape)));
    double z = 0.0;  // before the second sample, as in the estimator
    for (Eigen::Index i = 0; i < in.rows(); ++i) {
      const double end = v[i] > 0.0 ? 1.0 : (v[i] < 0.0 ? -1.0 : z);
      if (i > 0) z = end + (z - end) * column[i];
      column[i] = dahl.coordinates[0].unit_size * z;
    }
    return column;
  };
  dahl.gates_by_mode = true;
  dahl.own_groups = coulomb.own_groups;
  SetStarts(&dahl, {5});
  out->push_back(dahl);

  // LuGre: bristles whose reach depends on speed, and their own damping.
  EffectForm lugre = Reformulated(
      dahl, "lugre", "f + force z + damping z', z' = v (1 - z sign(v) / g) / distance, g = 1 + excess exp(-(v/v_s)^2)",
      {level,
       AmplitudeOf("damping", "N s", force, true),
       distance,
       stribeck_speed,
       {"excess", "-", 0.0, 1.5, 0.5, 0.5, 1.0, false}},
      2);
  lugre.features = [lugre](const Signals& in, const double* shape) -> Matrix {
    const Vector& v = in.at(Role::kVelocity);
    const double reach = ShapeValue(lugre, 0, shape), slow = ShapeValue(lugre, 1, shape),
                 excess = ShapeValue(lugre, 2, shape);
    const Vector level_of = 1.0 + excess * Exp(-(v / slow).cwiseAbs2()).array();
    const Vector kept = Exp(-v.cwiseAbs().cwiseQuotient(level_of) * (in.dt / reach));
    Matrix columns(in.rows(), 2);
    double z = 0.0;
    for (Eigen::Index i = 0; i < in.rows(); ++i) {
      const double g = level_of[i];
      const double end = v[i] > 0.0 ? g : (v[i] < 0.0 ? -g : z);
      const double next = end + (z - end) * kept[i];
      columns(i, 0) = in.output_scale * next;
      columns(i, 1) = in.output_scale * 0.01 * (next - z) / in.dt;
      z = next;
    }
    return columns;
  };
  SetStarts(&lugre, {3, 2, 1});
  out->push_back(lugre);
}

void AddMechanism(const Signals& s, std::vector<EffectForm>* out) {
  const double force = s.output_scale;
  EffectForm viscous =
      FromCore("viscous_friction", {AmplitudeOf("coefficient", "N s/m", force / s.scale_of(Role::kVelocity), true)});
  viscous.gates_by_mode = true;
  viscous.own_groups = {"speed", "speed in contact"};
  SetStarts(&viscous, {});
  out->push_back(viscous);
  EffectForm inertia = FromCore("inertia", {AmplitudeOf("mass", "kg", force / s.scale_of(Role::kAcceleration), true)});
  // Off line the acceleration comes from a smoother, not from a difference.
  inertia.features = [](const Signals& in, const double*) -> Matrix {
    return Scaled(in.at(Role::kAcceleration), in.output_scale / in.scale_of(Role::kAcceleration));
  };
  inertia.gates_by_mode = true;
  inertia.own_groups = {"acceleration"};
  SetStarts(&inertia, {});
  out->push_back(inertia);
}

void AddPeriodic(const Signals& s, std::vector<EffectForm>* out) {
  const double force = s.output_scale;
  const Coordinate frequency{"frequency", "Hz", std::log(3.0 / s.duration), std::log(0.25 / s.dt), std::log(10.0), 2.0,
                             1.0,         true};
  EffectForm sine = FromCore("periodic_disturbance", {AmplitudeOf("cosine", "N", force, false),
                                                      AmplitudeOf("sine", "N", force, false), frequency});
  const auto find_starts = [](std::size_t amplitudes) {
    return [amplitudes](const Signals& in, const Vector& residual) {
      std::vector<double> start(amplitudes, 0.0);
      start.push_back(std::log(std::max(StrongestLine(residual, in.dt).frequency, 3.0 / in.duration)));
      return std::vector<std::vector<double>>{start};
    };
  };
  sine.features = [sine](const Signals& in, const double* shape) -> Matrix {
    return sine.coordinates[0].unit_size * Waves(in.t, ShapeValue(sine, 0, shape), 1, 1);
  };
  sine.gates_by_mode = true;
  // One that begins or ends is lost in the spectrum of the whole.
  sine.find_starts = [whole = find_starts(2)](const Signals& in, const Vector& residual) {
    std::vector<std::vector<double>> starts = whole(in, residual);
    const Eigen::Index part = residual.size() / 4;
    for (const Vector& some : {Vector(residual.head(part)), Vector(residual.tail(part))}) {
      const Line line = StrongestLine(some, in.dt);
      if (line.frequency > 3.0 / in.duration) starts.push_back({0.0, 0.0, std::log(line.frequency)});
    }
    return starts;
  };
  out->push_back(sine);
  std::vector<Coordinate> coordinates;
  for (const char* name : {"cosine", "sine", "cosine3", "sine3", "cosine5", "sine5"})
    coordinates.push_back(AmplitudeOf(name, "N", force, false));
  coordinates.push_back(frequency);
  EffectForm square =
      Reformulated(sine, "odd_harmonics", "f + first, third and fifth harmonic of frequency", coordinates, 6);
  square.features = [square](const Signals& in, const double* shape) -> Matrix {
    const double f = ShapeValue(square, 0, shape);
    return in.output_scale * JoinColumns(Waves(in.t, f, 1, 1), JoinColumns(Waves(in.t, f, 3, 3), Waves(in.t, f, 5, 5)));
  };
  square.find_starts = find_starts(6);
  out->push_back(square);
}

}  // namespace

std::vector<EffectForm> ContactCatalogue(const Signals& signals) {
  std::vector<EffectForm> forms;
  AddSensorZero(signals, &forms);
  AddDryFriction(signals, &forms);
  AddMechanism(signals, &forms);
  for (EffectForm& form : LatencyForms(signals)) forms.push_back(std::move(form));
  AddMaterial(signals, &forms);
  AddSurfaceAndStiffness(signals, &forms);
  for (EffectForm& form : SaturationForms(signals)) forms.push_back(std::move(form));
  AddPeriodic(signals, &forms);
  AddUnlisted(signals, &forms);
  forms.push_back(DeadZoneForm(signals));
  return forms;
}

}  // namespace armcmc::gap
