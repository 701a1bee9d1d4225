#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "core/plant/described_packs.hpp"

namespace armcmc::test {

inline constexpr double kDt = 0.01;

/// A mass on a spring, moved by a drive; the output is the place of the mass.
inline PlantDescription Oscillator() {
  PlantDescription plant;
  plant.name = "oscillator";
  plant.output = "y";
  plant.law = "pos";
  plant.signals = {{"u", "N", "drive", ""}, {"y", "m", "position", ""}};
  plant.parameters = {{"m", "kg", "normal", 1.0, 0.5, 0.1, 5.0},
                      {"d", "N s/m", "normal", 0.5, 0.5, 0.0, 5.0},
                      {"k", "N/m", "normal", 20.0, 10.0, 1.0, 100.0}};
  plant.states = {{"pos", "m", "position", "speed", "y", "", 1},
                  {"speed", "m/s", "velocity", "(u - d*speed - k*pos)/m", "0", "", 2}};
  plant.noise.std = 0.002;
  return plant;
}

inline double Drive(double t) { return 3.0 * std::sin(2.1 * t) + 2.0 * std::sin(5.3 * t + 1.0); }

/// Two states by the same method with inputs linear between samples; place and speed of the oscillator.
struct Reference {
  using Rate = std::function<std::array<double, 2>(const std::array<double, 2>&, double)>;

  std::array<double, 2> x{};
  std::array<double, 3> theta{1.3, 0.8, 31.0};
  int substeps = 2;
  Rate rate = [this](const std::array<double, 2>& s, double u) {
    return std::array<double, 2>{s[1], (u - theta[1] * s[1] - theta[2] * s[0]) / theta[0]};
  };

  void Step(double u0, double u1) {
    const double h = kDt / substeps;
    for (int i = 0; i < substeps; ++i) {
      const auto at = [&](double part) { return u0 + (i + part) / substeps * (u1 - u0); };
      const auto moved = [&](const std::array<double, 2>& k, double by) {
        return std::array<double, 2>{x[0] + by * k[0], x[1] + by * k[1]};
      };
      const auto k1 = rate(x, at(0.0));
      const auto k2 = rate(moved(k1, 0.5 * h), at(0.5));
      const auto k3 = rate(moved(k2, 0.5 * h), at(0.5));
      const auto k4 = rate(moved(k3, h), at(1.0));
      for (std::size_t s = 0; s < 2; ++s) x[s] += h / 6.0 * (k1[s] + 2.0 * k2[s] + 2.0 * k3[s] + k4[s]);
    }
  }
};

/// The reference sampled one time after the other, with noise on the place.
struct ReferenceRun {
  PlantSample At(double t) {
    if (t > t_before + 0.5 * kDt) reference.Step(Drive(t_before), Drive(t));
    t_before = t;
    return {{Drive(t)}, reference.x[0] + noise()};
  }

  Reference reference;
  GaussianNoise noise{0.002};
  double t_before = kDt;
};

/// A pack of the plant prepared for the kernels, all candidates alike.
struct Laid {
  Laid(const PlantProgram& plant, const DataPack& pack, const StateMemory* before, const std::vector<double>& theta) {
    EXPECT_TRUE(plant.Prepare(pack, &memory, before, plant_pack.get()));
    plant.Fill(*plant_pack, pack.num_samples, 0, data.get());
    data->weighted = false;
    for (std::size_t d = 0; d < theta.size(); ++d) tile.value[d].fill(theta[d]);
  }
  expression::FeatureMemory memory;
  std::unique_ptr<PlantPack> plant_pack = std::make_unique<PlantPack>();
  std::unique_ptr<ModeData> data = std::make_unique<ModeData>();
  ThetaTile tile{};
};

}  // namespace armcmc::test
