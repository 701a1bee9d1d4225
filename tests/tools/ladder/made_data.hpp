#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "armcmc/ladder/dataset.hpp"

namespace armcmc::test {

/// What a sample of an axis is like: q = position, v = velocity, a = acceleration.
struct AxisSample {
  double t, q, v, a;
};

/// An axis q, v, a, F of 100 kg and 180 N s/m under a sum of three sines, 20 s at 100 Hz, whose force has `hidden` and
/// a noise of 2 N on top. The last 30 % are kept apart.
inline ladder::Dataset AxisData(const std::function<double(const AxisSample&)>& hidden, unsigned seed = 3) {
  auto series = std::make_shared<identify::Series>();
  series->dt = 0.01;
  series->runs = {0};
  series->signals.resize(4);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 2.0);
  ladder::Dataset data;
  for (int n = 0; n < 2000; ++n) {
    AxisSample s{0.01 * n, 0.0, 0.0, 0.0};
    const double amplitude[] = {0.05, 0.03, 0.01}, w[] = {1.7, 3.9, 8.3}, phase[] = {0.3, 2.0, 4.1};
    for (int i = 0; i < 3; ++i) {
      s.q += amplitude[i] * std::sin(w[i] * s.t + phase[i]);
      s.v += amplitude[i] * w[i] * std::cos(w[i] * s.t + phase[i]);
      s.a -= amplitude[i] * w[i] * w[i] * std::sin(w[i] * s.t + phase[i]);
    }
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
  PlantDescription plant;
  plant.name = "axis";
  plant.output = "F";
  plant.law = "M*a + Fv*v + off";
  plant.signals = {{"q", "m", "position", ""},
                   {"v", "m/s", "velocity", "q"},
                   {"a", "m/s^2", "acceleration", "v"},
                   {"F", "N", "force", ""}};
  plant.parameters = {{"M", "kg", "normal", 90.0, 30.0, 1.0, 500.0},
                      {"Fv", "N s/m", "normal", 200.0, 100.0, 0.0, 2000.0},
                      {"off", "N", "normal", 0.0, 10.0}};
  plant.noise.std = 1.0;
  return plant;
}

}  // namespace armcmc::test
