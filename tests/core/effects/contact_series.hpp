#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "armcmc/data_pack.hpp"
#include "armcmc/settings.hpp"
#include "plants/hunt_crossley/effect_sizes.hpp"
#include "plants/hunt_crossley/model.hpp"

namespace armcmc::test {

/// A recording of the contact plant as whole vectors: the reference knows no packs.
struct Series {
  double dt = 1e-3;
  double k = 4.0, b = 2.3, p = 1.7;
  std::vector<double> t, x, v, f;

  /// Taps of several depths with free motion between them, speeds of both signs and of all sizes.
  explicit Series(int samples) {
    for (int n = 0; n < samples; ++n) {
      const double s = dt * n;
      t.push_back(s);
      x.push_back(0.4 + 0.7 * std::sin(3.1 * s - 0.4) + 0.3 * std::sin(7.3 * s));
      v.push_back(0.7 * 3.1 * std::cos(3.1 * s - 0.4) + 0.3 * 7.3 * std::cos(7.3 * s));
    }
    f.assign(t.size(), 0.0);
  }
  [[nodiscard]] std::size_t size() const { return t.size(); }

  /// Samples [first, first + count) as pack number seq.
  [[nodiscard]] DataPack Pack(std::int64_t seq, std::size_t first, std::size_t count) const {
    DataPack pack;
    pack.seq = seq;
    pack.run_id = 1;
    pack.dt = dt;
    pack.plant = HuntCrossley::kInfo.plant;
    pack.num_samples = static_cast<int>(count);
    pack.num_inputs = 2;
    for (std::size_t n = 0; n < count; ++n) {
      pack.u[n] = {x[first + n], v[first + n]};
      pack.y[n] = f[first + n];
    }
    pack.t_last_s = t[first + count - 1];
    pack.t_last_ns = static_cast<Nanos>(pack.t_last_s * 1e9);
    return pack;
  }
};

/// Values of an effect for the reference: amplitudes and shapes by hand, in the order of the catalogue.
struct HiddenEffect {
  std::string name;
  std::vector<double> amplitude;
  std::vector<double> shape;
  EffectGate gate = EffectGate::kAlways;
  double from_s = 0.0, until_s = 0.0;
};

/// Fills series->f from the textbook formulas, sample by sample over the whole recording, in plain scalar code that
/// shares nothing with the library.
inline void Simulate(const std::vector<HiddenEffect>& effects, Series* s) {
  const auto find = [&](const char* name) -> const HiddenEffect* {
    for (const HiddenEffect& e : effects)
      if (e.name == name) return &e;
    return nullptr;
  };
  const auto open = [&](const HiddenEffect& e, std::size_t n) {
    if (e.gate == EffectGate::kContact) return s->x[n] >= 0.0;
    if (e.gate == EffectGate::kFree) return s->x[n] < 0.0;
    if (e.gate == EffectGate::kUntil) return s->t[n] < e.until_s;
    return e.gate != EffectGate::kFrom || s->t[n] >= e.from_s;
  };
  const std::size_t size = s->size();
  std::vector<double> from_surface = s->x;
  if (const auto* e = find("contact_offset"))
    for (std::size_t n = 0; n < size; ++n) from_surface[n] -= open(*e, n) ? e->amplitude[0] : 0.0;
  for (std::size_t n = 0; n < size; ++n) {
    const double x = from_surface[n];
    double k = s->k;
    if (const auto* e = find("stiffness_drift"); e && open(*e, n)) k *= 1.0 + e->amplitude[0] * (s->t[n] - e->shape[0]);
    s->f[n] = x > 0.0 ? k * std::pow(x, s->p) + s->b * std::pow(x, s->p) * s->v[n] : 0.0;
  }
  for (const HiddenEffect& e : effects) {
    double z = 0.0;  // of a filter
    for (std::size_t n = 0; n < size; ++n) {
      const double x = from_surface[n], v = s->v[n], t = s->t[n];
      const double depth = x > 0.0 ? x : 0.0;
      const double depth_before = n == 0 ? depth : std::max(from_surface[n - 1], 0.0);
      double force = 0.0;
      if (e.name == "force_bias") force = e.amplitude[0];
      if (e.name == "force_drift") force = e.amplitude[0] * (t - e.shape[0]);
      if (e.name == "coulomb_friction") force = e.amplitude[0] * std::tanh(v / e.shape[0]);
      if (e.name == "viscous_friction") force = e.amplitude[0] * v;
      if (e.name == "inertia") force = n == 0 ? 0.0 : e.amplitude[0] * (v - s->v[n - 1]) / s->dt;
      if (e.name == "adhesion" && v < 0.0 && x >= 0.0) force = -e.amplitude[0] * std::exp(-x / e.shape[0]);
      if (e.name == "periodic_disturbance")
        force = e.amplitude[0] * std::cos(2.0 * M_PI * e.shape[0] * t) +
                e.amplitude[1] * std::sin(2.0 * M_PI * e.shape[0] * t);
      if (e.name == "presliding_friction") {
        // Dahl's equation in small steps of the distance.
        constexpr int kSteps = 200;
        for (int i = 0; n > 0 && i < kSteps; ++i) {
          const double dx = v * s->dt / kSteps;
          const double half = z + 0.5 * dx * (1.0 - (v > 0.0 ? z : -z)) / e.shape[0];
          z += dx * (1.0 - (v > 0.0 ? half : -half)) / e.shape[0];
        }
        force = e.amplitude[0] * z;
      }
      if (e.name == "stress_relaxation") {
        // z = x+ - y,  z' = x+' - z / tau, in small steps.
        constexpr int kSteps = 200;
        const double h = s->dt / kSteps;
        const double slope = (depth - depth_before) / s->dt;
        for (int i = 0; n > 0 && i < kSteps; ++i) {
          const double half = z + 0.5 * h * (slope - z / e.shape[0]);
          z += h * (slope - half / e.shape[0]);
        }
        force = e.amplitude[0] * z;
      }
      if (open(e, n)) s->f[n] += force;
    }
  }
  if (const auto* e = find("sensor_delay")) {
    const std::vector<double> in = s->f;
    for (std::size_t n = 0; n < size; ++n) {
      const double at = static_cast<double>(n) - e->amplitude[0] / s->dt;
      const double node = std::floor(at);
      if (!open(*e, n)) continue;
      if (at <= 0.0) {
        s->f[n] = in[0];
      } else {
        const auto i = static_cast<std::size_t>(node);
        s->f[n] = in[i] + (at - node) * (in[std::min(i + 1, size - 1)] - in[i]);
      }
    }
  }
  if (const auto* e = find("sensor_lag")) {
    double g = s->f[0];
    double before = s->f[0];
    for (std::size_t n = 1; n < size; ++n) {
      constexpr int kSteps = 200;
      const double f = s->f[n];
      for (int i = 0; i < kSteps; ++i) {
        const double h = s->dt / kSteps;
        const auto in = [&](double part) { return before + (f - before) * part; };
        const double half = g + 0.5 * h * (in(i * 1.0 / kSteps) - g) / e->amplitude[0];
        g += h * (in((i + 0.5) / kSteps) - half) / e->amplitude[0];
      }
      before = f;
      if (open(*e, n)) s->f[n] = g;
    }
  }
  if (const auto* e = find("sensor_saturation"))
    for (std::size_t n = 0; n < size; ++n)
      if (open(*e, n)) s->f[n] = std::min(s->f[n], e->amplitude[0]);
}

/// One value for every effect of the catalogue, of a size that the motion of Series shows.
inline std::vector<HiddenEffect> Catalogue() {
  return {{"force_bias", {0.7}, {}},
          {"force_drift", {0.4}, {0.5}},
          {"coulomb_friction", {0.6}, {0.05}},
          {"presliding_friction", {0.6}, {0.04}},
          {"viscous_friction", {0.5}, {}},
          {"inertia", {0.3}, {0.0}},
          {"sensor_delay", {0.0073}, {}},
          {"sensor_lag", {0.006}, {}},
          {"stress_relaxation", {2.0}, {0.2}},
          {"adhesion", {0.8}, {0.15}},
          {"contact_offset", {0.12}, {}},
          {"sensor_saturation", {6.0}, {}},
          {"periodic_disturbance", {0.4, -0.3}, {9.0}},
          {"stiffness_drift", {0.2}, {0.5}}};
}

/// The settings of an estimator that knows the effect, with a prior that does not know its size.
inline EffectSettings SettingsOf(const HiddenEffect& hidden) {
  EffectSettings effect = MakeEffect(HuntCrossley::kInfo, hidden.name,
                                     ContactScales{.force = 5.0, .length = 1.0, .speed = 2.0, .acceleration = 8.0});
  effect.gate = hidden.gate;
  effect.from_s = hidden.from_s;
  effect.until_s = hidden.until_s;
  for (std::size_t i = 0; i < hidden.shape.size(); ++i) effect.shapes[i] = hidden.shape[i];
  if (hidden.name == "sensor_lag") effect.amplitudes[0].upper = 0.02;
  // Effects that depend on the depth count it from where the prior has the surface.
  if (hidden.name == "contact_offset") effect.amplitudes[0].mean = hidden.amplitude[0];
  // A limit above every force has no gradient: its prior must know about where it is.
  if (hidden.name == "sensor_saturation")
    effect.amplitudes[0] = {"limit", PriorKind::kNormal, 1.1 * hidden.amplitude[0], 1.0, 0.0, 50.0};
  return effect;
}

inline EstimatorSettings WithEffects(const std::vector<HiddenEffect>& effects) {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  for (const HiddenEffect& e : effects)
    settings.effects[static_cast<std::size_t>(settings.num_effects++)] = SettingsOf(e);
  return settings;
}

}  // namespace armcmc::test
