#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "armcmc/ladder/dataset.hpp"
#include "core/plant/plants.hpp"

namespace armcmc::test {

/// What a sample of an axis is like: q = position, v = velocity, a = acceleration.
struct AxisSample {
  double t, q, v, a;
};

/// A sum of three sines.
inline AxisSample ThreeSines(double t) {
  AxisSample s{t, 0.0, 0.0, 0.0};
  const double amplitude[] = {0.05, 0.03, 0.01}, w[] = {1.7, 3.9, 8.3}, phase[] = {0.3, 2.0, 4.1};
  for (int i = 0; i < 3; ++i) {
    s.q += amplitude[i] * std::sin(w[i] * t + phase[i]);
    s.v += amplitude[i] * w[i] * std::cos(w[i] * t + phase[i]);
    s.a -= amplitude[i] * w[i] * w[i] * std::sin(w[i] * t + phase[i]);
  }
  return s;
}

/// An axis q, v, a, F of 100 kg and 180 N s/m that is moved for 20 s at 100 Hz, whose force has `hidden` and a noise of
/// 2 N on top. The last 30 % are kept apart.
inline ladder::Dataset AxisData(const std::function<double(const AxisSample&)>& hidden, unsigned seed = 3,
                                AxisSample (*motion)(double t) = ThreeSines) {
  auto series = std::make_shared<identify::Series>();
  series->dt = 0.01;
  series->runs = {0};
  series->signals.resize(4);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 2.0);
  ladder::Dataset data;
  for (int n = 0; n < 2000; ++n) {
    const AxisSample s = motion(0.01 * n);
    series->t.push_back(s.t);
    series->signals[0].push_back(s.q);
    series->signals[1].push_back(s.v);
    series->signals[2].push_back(s.a);
    series->signals[3].push_back(100.0 * s.a + 180.0 * s.v + hidden(s) + noise(random));
    data.training.push_back(n < 1400 ? 1 : 0);
    data.held_out.push_back(n < 1400 ? 0 : 1);
  }
  data.series = std::move(series);
  return data;
}

/// The axis without anything hidden.
inline PlantDescription AxisPlant() {
  PlantDescription plant = DescribedAxis();
  plant.signals.insert(plant.signals.begin(), {"q", "m", "position", ""});
  plant.signals[1].derivative_of = "q";
  return plant;
}

/// What is simulated from an input alone; the last 30 % are kept apart.
struct SimulatedRun {
  int rows;
  double noise;  ///< Standard deviation on what is measured.
  unsigned seed;
  std::function<double(double t)> drive;
  std::function<void(double u, double step)> advance;  ///< By one step of the integration, a twentieth of a sample.
  std::function<double()> shown;                       ///< What is measured, without noise.
  double dt = 0.02;                                    ///< s
};

inline ladder::Dataset DataOf(const SimulatedRun& run) {
  constexpr int kSteps = 20;  // of an interval
  const double step = run.dt / kSteps;
  auto series = std::make_shared<identify::Series>();
  series->dt = run.dt;
  series->runs = {0};
  series->signals.resize(2);
  std::mt19937_64 random(run.seed);
  std::normal_distribution<double> noise(0.0, run.noise);
  ladder::Dataset data;
  for (int n = 0; n < run.rows; ++n) {
    const double t = run.dt * n;
    series->t.push_back(t);
    series->signals[0].push_back(run.drive(t));
    series->signals[1].push_back(run.shown() + noise(random));
    data.training.push_back(10 * n < 7 * run.rows ? 1 : 0);
    data.held_out.push_back(10 * n < 7 * run.rows ? 0 : 1);
    for (int i = 0; i < kSteps; ++i) run.advance(run.drive(t + (i + 0.5) * step), step);
  }
  data.series = std::move(series);
  return data;
}

/// A mass on a spring and a damper u, y: 1 kg, 0.6 N s/m, `spring` (20 N/m), driven by `felt` of a sum of sines, from
/// rest; 40 s, a noise of 3 mm on the place.
inline ladder::Dataset SwingData(
    const std::function<double(double)>& felt,
    const std::function<double(double)>& spring = [](double pos) { return 20.0 * pos; }) {
  double pos = 0.0, speed = 0.0;
  return DataOf({.rows = 2000,
                 .noise = 0.003,
                 .seed = 7,
                 .drive =
                     [](double t) {
                       return 5.0 * std::sin(1.3 * t) + 4.0 * std::sin(3.1 * t + 1.0) + 3.0 * std::sin(5.7 * t + 2.0);
                     },
                 .advance =
                     [&](double u, double step) {  // semi-implicit, fine enough
                       speed += step * (felt(u) - 0.6 * speed - spring(pos));
                       pos += step * speed;
                     },
                 .shown = [&] { return pos; }});
}

/// The swing without anything hidden.
inline PlantDescription SwingPlant() {
  PlantDescription plant;
  plant.name = "swing";
  plant.output = "y";
  plant.law = "pos";
  plant.signals = {{"u", "N", "drive", ""}, {"y", "m", "position", ""}};
  plant.parameters = {{"m", "kg", "lognormal", 0.7, 1.0},
                      {"d", "N s/m", "normal", 0.5, 2.0, 0.0, 50.0},
                      {"k", "N/m", "normal", 10.0, 20.0, 0.0, 100.0}};
  plant.states = {{"pos", "m", "position", "speed", "0", "", 1},
                  {"speed", "m/s", "velocity", "(u - d*speed - k*pos)/m", "0", "", 1}};
  plant.noise.std = 0.003;
  return plant;
}

/// A motor u, w: 70 rad/s^2/V, which `gain` scales at a speed w under a voltage u, a time constant of 0.25 s, driven by
/// a sum of sines, from rest; 20 s, a noise of 0.3 rad/s on the speed.
inline ladder::Dataset MotorData(const std::function<double(double w, double u)>& gain) {
  double w = 0.0;
  return DataOf({.rows = 1000,
                 .noise = 0.3,
                 .seed = 11,
                 .drive =
                     [](double t) {
                       return 3.5 * std::sin(0.9 * t) + 2.5 * std::sin(3.7 * t + 1.0) + 2.0 * std::sin(11.0 * t + 2.0);
                     },
                 .advance = [&](double u, double step) { w += step * (70.0 * gain(w, u) * u - w / 0.25); },
                 .shown = [&] { return w; }});
}

/// The motor without anything hidden.
inline PlantDescription MotorPlant() {
  PlantDescription plant;
  plant.name = "motor";
  plant.output = "w";
  plant.law = "speed";
  plant.signals = {{"u", "V", "drive", ""}, {"w", "rad/s", "velocity", ""}};
  plant.parameters = {{"K", "rad/s^2/V", "normal", 50.0, 30.0, 1.0, 500.0}, {"T", "s", "lognormal", 0.3, 0.7}};
  plant.states = {{"speed", "rad/s", "velocity", "K*u - speed/T", "0", "", 1}};
  plant.noise.std = 0.3;
  return plant;
}

/// Two tanks in a cascade u, y, the upper fed by a pump, the level of the lower measured; of what is `spilled` by the
/// upper, half reaches the lower. 20 minutes, a noise of 0.03 V on the level.
inline ladder::Dataset TanksData(const std::function<double(double level)>& spilled) {
  double upper = 3.0, lower = 2.5;
  return DataOf({.rows = 600,
                 .noise = 0.03,
                 .seed = 5,
                 .drive =
                     [](double t) {
                       const double step = std::floor(t / 80.0), chaos = 43758.5 * std::sin(12.9898 * step);
                       return 0.5 + 4.5 * (chaos - std::floor(chaos));
                     },
                 .advance =
                     [&](double u, double step) {
                       const double over = spilled(upper), passes = 0.05 * std::sqrt(upper);
                       upper += step * (0.04 * u - passes - over);
                       lower += step * (passes - 0.045 * std::sqrt(lower) + 0.5 * over);
                     },
                 .shown = [&] { return lower; },
                 .dt = 2.0});
}

}  // namespace armcmc::test
