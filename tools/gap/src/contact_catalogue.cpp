#include <algorithm>
#include <cmath>
#include <vector>

#include "armcmc/effects/registry.hpp"
#include "armcmc/gap/contact_equation.hpp"
#include "armcmc/gap/features.hpp"
#include "armcmc/gap/sensor_forms.hpp"
#include "armcmc/gap/smoothing.hpp"

namespace armcmc::gap {
namespace {

/// An amplitude of a force-like effect: normal prior of a fifth of the rms force.
Coordinate Amplitude(const char* name, const char* unit, double unit_size, bool has_sign, double sd = 0.2,
                     double upper = 3.0) {
  return {name, unit, has_sign ? 0.0 : -upper, upper, 0.0, sd, unit_size, false};
}

/// A length, speed or time: log-normal around the middle of its range, given in multiples of `unit_size`.
Coordinate Shape(const char* name, const char* unit, double unit_size, double lower, double upper) {
  const double low = std::log(lower), high = std::log(upper);
  return {name, unit, low, high, 0.5 * (low + high), 1.0, unit_size, true};
}

/// The same, with bounds beyond which the effect would be another.
Coordinate Below(Coordinate shape) {
  shape.other_above = true;
  return shape;
}
Coordinate Above(Coordinate shape) {
  shape.other_below = true;
  return shape;
}

/// `count` values spread evenly over the inside of a coordinate's range.
std::vector<double> Spread(const Coordinate& c, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(c.lower + (c.upper - c.lower) * (i + 0.5) / count);
  return values;
}

/// Starts with amplitudes of zero, over a grid of all shapes.
void AddStarts(EffectForm* form, const std::vector<int>& counts) {
  std::vector<std::vector<double>> grid{std::vector<double>(static_cast<std::size_t>(form->num_amplitudes), 0.0)};
  for (std::size_t s = 0; s < counts.size(); ++s) {
    const Coordinate& c = form->coordinates[static_cast<std::size_t>(form->num_amplitudes) + s];
    std::vector<std::vector<double>> wider;
    for (const std::vector<double>& start : grid)
      for (const double value : Spread(c, counts[s])) {
        wider.push_back(start);
        wider.back().push_back(value);
      }
    grid = std::move(wider);
  }
  form->starts = std::move(grid);
}

/// The estimator's own feature of an additive effect, over the whole recording.
Matrix CoreFeature(int effect, const Signals& s, const double* shape_values) {
  const auto index = static_cast<std::size_t>(effect);
  const EffectFeatureFn feature = AllEffects::kFeatures[index];
  Matrix columns(s.rows(), AllEffects::kInfos[index]->num_amplitudes);
  std::array<double, kEffectMemory> memory{};
  std::array<double, kMaxEffectAmplitudes> value{};
  for (Eigen::Index i = 0; i < s.rows(); ++i) {
    const EffectInput in{
        .t = s.t[i], .dt = s.dt, .x = s.at(Role::kPosition)[i], .v = s.at(Role::kVelocity)[i], .first = i == 0};
    feature(in, shape_values, memory.data(), value.data());
    for (Eigen::Index a = 0; a < columns.cols(); ++a) columns(i, a) = value[static_cast<std::size_t>(a)];
  }
  return columns;
}

/// An effect of the estimator's catalogue: name, family, formula and feature are the estimator's. `coordinates` are its
/// amplitudes and shapes; the feature is given the physical values of the shapes.
EffectForm FromCore(const char* name, std::vector<Coordinate> coordinates) {
  const int index = FindEffect(name);
  const EffectInfo& info = *AllEffects::kInfos[static_cast<std::size_t>(index)];
  EffectForm form;
  form.effect = name;
  form.family = info.family;
  form.formula = info.formula;
  form.slot = Slot::kAdditive;
  form.coordinates = std::move(coordinates);
  form.num_amplitudes = info.num_amplitudes;
  const std::vector<Coordinate> all = form.coordinates;
  const int amplitudes = form.num_amplitudes;
  form.features = [index, all, amplitudes](const Signals& s, const double* shape) {
    std::array<double, kMaxEffectShapes> values{};
    for (std::size_t i = static_cast<std::size_t>(amplitudes); i < all.size(); ++i)
      values[i - static_cast<std::size_t>(amplitudes)] = all[i].Value(shape[i - static_cast<std::size_t>(amplitudes)]);
    Matrix columns = CoreFeature(index, s, values.data());
    for (Eigen::Index a = 0; a < columns.cols(); ++a) columns.col(a) *= all[static_cast<std::size_t>(a)].unit_size;
    return columns;
  };
  return form;
}

/// Probability that the true speed is negative, given the smoothed one.
Vector Retracting(const Signals& s) {
  const double spread = std::max(s.smoothed_velocity_noise, 1e-9 * s.scale_of(Role::kVelocity));
  return s.at(Role::kVelocity).unaryExpr([spread](double v) { return 0.5 * std::erfc(v / (std::sqrt(2.0) * spread)); });
}

/// A further formula of an effect.
EffectForm Variant(const EffectForm& base, const char* variant, const char* formula,
                   std::vector<Coordinate> coordinates, int num_amplitudes) {
  EffectForm form = base;
  form.variant = variant;
  form.formula = formula;
  form.coordinates = std::move(coordinates);
  form.num_amplitudes = num_amplitudes;
  form.features = nullptr;
  form.starts.clear();
  return form;
}

double Value(const EffectForm& form, std::size_t shape_index, const double* shape) {
  return form.coordinates[static_cast<std::size_t>(form.num_amplitudes) + shape_index].Value(shape[shape_index]);
}

Vector Scaled(const Vector& series, double scale) { return series * scale; }

void AddSensorZero(const Signals& s, std::vector<EffectForm>* out) {
  const double force = s.output_scale;
  EffectForm bias = FromCore("force_bias", {Amplitude("force", "N", force, false)});
  AddStarts(&bias, {});
  bias.own_groups = {"time"};
  out->push_back(bias);
  EffectForm drift = FromCore("force_drift", {Amplitude("rate", "N/s", force / s.duration, false),
                                              {"origin", "s", 0.0, 0.0, 0.0, 1.0, 1.0, false}});
  // The origin is the start of the recording: a constant beside the drift is another effect.
  drift.coordinates.pop_back();
  drift.features = [](const Signals& in, const double*) -> Matrix { return in.output_scale * in.Elapsed(); };
  AddStarts(&drift, {});
  drift.own_groups = {"time"};
  out->push_back(drift);
  EffectForm exponential =
      Variant(drift, "exponential", "f + force (1 - exp(-t / time_constant))",
              {Amplitude("force", "N", force, false), Above(Shape("time_constant", "s", s.duration, 0.05, 1.5))}, 1);
  exponential.features = [exponential](const Signals& in, const double* shape) -> Matrix {
    const double tau = Value(exponential, 0, shape);
    return in.output_scale * (1.0 - (-(in.t.array() - in.origin) / tau).exp()).matrix();
  };
  AddStarts(&exponential, {3});
  out->push_back(exponential);
}

void AddDryFriction(const Signals& s, std::vector<EffectForm>* out) {
  const double force = s.output_scale, speed = s.scale_of(Role::kVelocity), length = s.scale_of(Role::kPosition);
  const Coordinate level = Amplitude("force", "N", force, true);
  const Coordinate width = Below(Shape("speed", "m/s", speed, 0.003, 0.4));
  const Coordinate distance = Below(Shape("distance", "m", length, 0.003, 0.6));
  const Coordinate stribeck_speed = Shape("stribeck_speed", "m/s", speed, 0.03, 1.0);
  EffectForm coulomb = FromCore("coulomb_friction", {level, width});
  coulomb.gates_by_mode = true;
  coulomb.own_groups = {"speed", "direction of motion", "distance since reversal"};
  AddStarts(&coulomb, {5});
  out->push_back(coulomb);

  EffectForm stribeck =
      Variant(coulomb, "stribeck", "f + (force + excess exp(-(v / stribeck_speed)^2)) tanh(v / speed)",
              {level, Amplitude("excess", "N", force, true), width, stribeck_speed}, 2);
  stribeck.features = [stribeck](const Signals& in, const double* shape) -> Matrix {
    const Eigen::ArrayXd v = in.at(Role::kVelocity).array();
    Matrix columns(in.rows(), 2);
    columns.col(0) = in.output_scale * (v / Value(stribeck, 0, shape)).tanh();
    columns.col(1) = columns.col(0).array() * (-(v / Value(stribeck, 1, shape)).square()).exp();
    return columns;
  };
  AddStarts(&stribeck, {3, 3});
  out->push_back(stribeck);

  EffectForm dahl = FromCore("presliding_friction", {level, distance});
  dahl.gates_by_mode = true;
  dahl.own_groups = coulomb.own_groups;
  AddStarts(&dahl, {5});
  out->push_back(dahl);

  // LuGre: bristles whose reach depends on speed, and their own damping.
  EffectForm lugre = Variant(
      dahl, "lugre", "f + force z + damping z', z' = v (1 - z sign(v) / g) / distance, g = 1 + excess exp(-(v/v_s)^2)",
      {level,
       Amplitude("damping", "N s", force, true),
       distance,
       stribeck_speed,
       {"excess", "-", 0.0, 1.5, 0.5, 0.5, 1.0, false}},
      2);
  lugre.features = [lugre](const Signals& in, const double* shape) -> Matrix {
    const Vector& v = in.at(Role::kVelocity);
    const double reach = Value(lugre, 0, shape), slow = Value(lugre, 1, shape), excess = Value(lugre, 2, shape);
    Matrix columns(in.rows(), 2);
    double z = 0.0;
    for (Eigen::Index i = 0; i < in.rows(); ++i) {
      const double ratio = v[i] / slow;
      const double g = 1.0 + excess * std::exp(-ratio * ratio);
      const double end = v[i] > 0.0 ? g : (v[i] < 0.0 ? -g : z);
      const double next = end + (z - end) * std::exp(-std::abs(v[i]) * in.dt / (reach * g));
      columns(i, 0) = in.output_scale * next;
      columns(i, 1) = in.output_scale * 0.01 * (next - z) / in.dt;
      z = next;
    }
    return columns;
  };
  AddStarts(&lugre, {3, 2, 1});
  out->push_back(lugre);
}

void AddMechanism(const Signals& s, std::vector<EffectForm>* out) {
  const double force = s.output_scale;
  EffectForm viscous =
      FromCore("viscous_friction", {Amplitude("coefficient", "N s/m", force / s.scale_of(Role::kVelocity), true)});
  viscous.gates_by_mode = true;
  viscous.own_groups = {"speed", "speed in contact"};
  AddStarts(&viscous, {});
  out->push_back(viscous);
  EffectForm inertia = FromCore("inertia", {Amplitude("mass", "kg", force / s.scale_of(Role::kAcceleration), true)});
  // Off line the acceleration comes from a smoother, not from a difference.
  inertia.features = [](const Signals& in, const double*) -> Matrix {
    return Scaled(in.at(Role::kAcceleration), in.output_scale / in.scale_of(Role::kAcceleration));
  };
  inertia.gates_by_mode = true;
  inertia.own_groups = {"acceleration"};
  AddStarts(&inertia, {});
  out->push_back(inertia);
}

void AddMaterial(const Signals& s, std::vector<EffectForm>* out) {
  const double force = s.output_scale, length = s.scale_of(Role::kPosition);
  const Coordinate stiffness = Amplitude("stiffness", "N/m", force / length, true, 0.5, 20.0);
  const Coordinate tau = Below(Shape("time_constant", "s", 1.0, 15.0 * s.dt, 0.4 * s.duration));
  // What the branch remembers of the time before the recording: 1 it had relaxed, 0 it had seen nothing.
  const Coordinate start = Below({"start", "-", 0.0, 1.3, 1.0, 0.5, 1.0, false});
  EffectForm relaxation = FromCore("stress_relaxation", {stiffness, tau, start});
  relaxation.features = [relaxation](const Signals& in, const double* shape) -> Matrix {
    const Vector depth = in.at(Role::kPosition).cwiseMax(0.0);
    return relaxation.coordinates[0].unit_size * (depth - Leaky(depth, Value(relaxation, 0, shape) / in.dt, shape[1]));
  };
  relaxation.own_groups = {"memory of the past", "distance since reversal"};
  AddStarts(&relaxation, {6, 2});
  out->push_back(relaxation);

  EffectForm elastic = Variant(relaxation, "elastic", "f + share q, q' = (K x^p)' - q / time_constant",
                               {Amplitude("share", "-", 1.0, true, 0.5, 20.0), tau, start}, 1);
  elastic.slot = Slot::kMemory;
  elastic.filter = [elastic](const Signals& in, const Vector& series, int, const double* shape) -> Vector {
    return series - Leaky(series, Value(elastic, 0, shape) / in.dt, shape[1]);
  };
  AddStarts(&elastic, {6, 2});
  out->push_back(elastic);

  EffectForm two = Variant(relaxation, "two_time_constants", "f + share1 q1 + share2 q2, qi' = (K x^p)' - qi / taui",
                           {Amplitude("share_fast", "-", 1.0, true, 0.5, 20.0),
                            Amplitude("share_slow", "-", 1.0, true, 0.5, 20.0),
                            tau,
                            {"ratio", "-", std::log(2.0), std::log(20.0), std::log(6.0), 0.6, 1.0, true}},
                           2);
  two.slot = Slot::kMemory;
  two.filter = [two](const Signals& in, const Vector& series, int amplitude, const double* shape) -> Vector {
    const double fast = Value(two, 0, shape);
    const double tau_s = amplitude == 0 ? fast : fast * Value(two, 1, shape);
    return series - Leaky(series, tau_s / in.dt);
  };
  AddStarts(&two, {4, 1});
  out->push_back(two);

  const Coordinate tension = Amplitude("force", "N", force, true, 0.3);
  const Coordinate reach = Below(Shape("distance", "m", length, 0.015, 1.2));
  EffectForm adhesion = FromCore("adhesion", {tension, reach});
  adhesion.features = [adhesion](const Signals& in, const double* shape) -> Matrix {
    const Eigen::ArrayXd x = in.at(Role::kPosition).array();
    const Eigen::ArrayXd pull = in.output_scale * (-x.max(0.0) / Value(adhesion, 0, shape)).exp();
    return (-pull * Retracting(in).array() * (x >= 0.0).cast<double>()).matrix();
  };
  adhesion.own_groups = {"direction of motion"};
  AddStarts(&adhesion, {4});
  out->push_back(adhesion);
  // The neck that holds on outside the surface until it breaks.
  EffectForm neck = Variant(adhesion, "pull_off",
                            "f - force n(x) while retracting, n = exp(-x / distance) inside, 1 + x / distance outside",
                            {tension, reach}, 1);
  neck.features = [neck](const Signals& in, const double* shape) -> Matrix {
    const Vector& x = in.at(Role::kPosition);
    const Vector& v = in.at(Role::kVelocity);
    const double d = Value(neck, 0, shape);
    Vector column = Vector::Zero(in.rows());
    bool bonded = false;
    for (Eigen::Index i = 0; i < in.rows(); ++i) {
      if (x[i] >= 0.0) bonded = true;
      if (x[i] <= -d) bonded = false;
      if (bonded && v[i] < 0.0) column[i] = -in.output_scale * (x[i] >= 0.0 ? std::exp(-x[i] / d) : 1.0 + x[i] / d);
    }
    return column;
  };
  AddStarts(&neck, {4});
  out->push_back(neck);
  EffectForm tail =
      Variant(adhesion, "power_law", "f - force / (1 + x / distance)^2 for v < 0, x >= 0", {tension, reach}, 1);
  tail.features = [tail](const Signals& in, const double* shape) -> Matrix {
    const Eigen::ArrayXd x = in.at(Role::kPosition).array();
    const Eigen::ArrayXd pull = in.output_scale / (1.0 + x.max(0.0) / Value(tail, 0, shape)).square();
    return (-pull * Retracting(in).array() * (x >= 0.0).cast<double>()).matrix();
  };
  AddStarts(&tail, {3});
  out->push_back(tail);
}

void AddSurfaceAndStiffness(const Signals& s, std::vector<EffectForm>* out) {
  EffectForm offset =
      FromCore("contact_offset", {{"distance", "m", -0.8, 0.8, 0.0, 0.2, s.scale_of(Role::kPosition), false}});
  offset.slot = Slot::kInputMap;
  offset.features = [](const Signals& in, const double*) -> Matrix {
    return Vector::Constant(in.rows(), in.scale_of(Role::kPosition));
  };
  offset.linear = false;
  offset.starts = {{-0.3}, {-0.1}, {-0.02}, {0.02}, {0.1}, {0.3}};
  out->push_back(offset);

  EffectForm drift = FromCore("stiffness_drift", {{"rate", "1/s", -0.95, 3.0, 0.0, 0.3, 1.0 / s.duration, false}});
  drift.slot = Slot::kParameter;
  drift.features = [](const Signals& in, const double*) -> Matrix { return in.Elapsed(); };
  drift.own_groups = {"time x force"};
  AddStarts(&drift, {});
  out->push_back(drift);
  EffectForm exponential = Variant(
      drift, "exponential", "K (1 + share (1 - exp(-t / time_constant))) in place of K",
      {{"share", "-", -0.95, 3.0, 0.0, 0.3, 1.0, false}, Above(Shape("time_constant", "s", s.duration, 0.05, 1.5))}, 1);
  exponential.features = [exponential](const Signals& in, const double* shape) -> Matrix {
    const double tau = Value(exponential, 0, shape);
    return (1.0 - (-(in.t.array() - in.origin) / tau).exp()).matrix();
  };
  AddStarts(&exponential, {3});
  out->push_back(exponential);
}

void AddPeriodic(const Signals& s, std::vector<EffectForm>* out) {
  const double force = s.output_scale;
  const Coordinate frequency{"frequency", "Hz", std::log(3.0 / s.duration), std::log(0.25 / s.dt), std::log(10.0), 2.0,
                             1.0,         true};
  EffectForm sine = FromCore("periodic_disturbance",
                             {Amplitude("cosine", "N", force, false), Amplitude("sine", "N", force, false), frequency});
  const auto find_starts = [](std::size_t amplitudes) {
    return [amplitudes](const Signals& in, const Vector& residual) {
      std::vector<double> start(amplitudes, 0.0);
      start.push_back(std::log(std::max(StrongestLine(residual, in.dt).frequency, 3.0 / in.duration)));
      return std::vector<std::vector<double>>{start};
    };
  };
  sine.find_starts = find_starts(2);
  out->push_back(sine);
  std::vector<Coordinate> coordinates;
  for (const char* name : {"cosine", "sine", "cosine3", "sine3", "cosine5", "sine5"})
    coordinates.push_back(Amplitude(name, "N", force, false));
  coordinates.push_back(frequency);
  EffectForm square =
      Variant(sine, "odd_harmonics", "f + first, third and fifth harmonic of frequency", coordinates, 6);
  square.features = [square](const Signals& in, const double* shape) -> Matrix {
    const double f = Value(square, 0, shape);
    return in.output_scale * Beside(Waves(in.t, f, 1, 1), Beside(Waves(in.t, f, 3, 3), Waves(in.t, f, 5, 5)));
  };
  square.find_starts = find_starts(6);
  out->push_back(square);
}

/// Physics that is not in the catalogue. It competes and is described, never named.
void AddUnlisted(const Signals& s, std::vector<EffectForm>* out) {
  const double force = s.output_scale, speed = s.scale_of(Role::kVelocity), length = s.scale_of(Role::kPosition);
  EffectForm drag;
  drag.listed = false;
  drag.effect = "drag that grows with the square of speed";
  drag.family = "quadratic drag";
  drag.formula = "f + drag v |v|";
  drag.coordinates = {Amplitude("drag", "N s^2/m^2", force / (speed * speed), true)};
  drag.features = [](const Signals& in, const double*) -> Matrix {
    const Vector u = in.at(Role::kVelocity) / in.scale_of(Role::kVelocity);
    return in.output_scale * u.cwiseProduct(u.cwiseAbs());
  };
  AddStarts(&drag, {});
  out->push_back(drag);

  EffectForm stiffening = drag;
  stiffening.effect = "stiffness that grows with depth";
  stiffening.family = "strain stiffening";
  stiffening.formula = "K (1 + share (exp(x / length) - 1)) in place of K";
  stiffening.slot = Slot::kParameter;
  stiffening.coordinates = {{"share", "-", -0.9, 30.0, 0.0, 0.5, 1.0, false}, Shape("length", "m", length, 0.15, 2.0)};
  stiffening.features = [stiffening](const Signals& in, const double* shape) -> Matrix {
    const double scale = Value(stiffening, 0, shape);
    return (in.at(Role::kPosition).cwiseMax(0.0) / scale).array().min(30.0).exp() - 1.0;
  };
  AddStarts(&stiffening, {4});
  out->push_back(stiffening);

  EffectForm ripple = drag;
  ripple.effect = "a ripple along the path";
  ripple.family = "spatial ripple";
  ripple.formula = "f + cosine cos(2 pi x / wavelength) + sine sin(2 pi x / wavelength) in contact";
  ripple.num_amplitudes = 2;
  ripple.coordinates = {Amplitude("cosine", "N", force, false), Amplitude("sine", "N", force, false),
                        Shape("wavelength", "m", length, 0.08, 2.0)};
  ripple.features = [ripple](const Signals& in, const double* shape) -> Matrix {
    return in.output_scale * Gated(Waves(in.at(Role::kPosition), 1.0 / Value(ripple, 0, shape), 1, 1), in.active);
  };
  AddStarts(&ripple, {24});
  out->push_back(ripple);

  EffectForm load = drag;
  load.effect = "friction that grows with the contact force";
  load.family = "load friction";
  load.formula = "f + share K x^p tanh(v / speed)";
  load.slot = Slot::kMemory;
  load.coordinates = {Amplitude("share", "-", 1.0, true, 0.3), Shape("speed", "m/s", speed, 0.003, 0.4)};
  load.filter = [load](const Signals& in, const Vector& series, int, const double* shape) -> Vector {
    return series.array() * (in.at(Role::kVelocity) / Value(load, 0, shape)).array().tanh();
  };
  AddStarts(&load, {3});
  out->push_back(load);
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
