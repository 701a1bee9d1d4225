#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "armcmc/data_pack.hpp"

namespace armcmc::test {

struct ContactTruth {
  double k = 4.0, b = 2.3, p = 1.7;
};

/// Normal numbers that do not depend on the standard library: Box-Muller on mt19937_64.
class Normal {
 public:
  explicit Normal(std::uint64_t seed) : engine_(seed) {}
  double Uniform() { return (static_cast<double>(engine_() >> 11) + 0.5) * 0x1p-53; }
  double operator()() { return std::sqrt(-2.0 * std::log(Uniform())) * std::cos(6.283185307179586 * Uniform()); }

 private:
  std::mt19937_64 engine_;
};

/// One pack of 100 samples of the motion x(t) = depth + swing sin(2 pi hertz t + phase) with Gaussian force noise.
struct Motion {
  double depth = 1.0, swing = 0.5, hertz = 10.0, phase = 0.0;
};

inline DataPack MakeContactPack(std::int64_t seq, const Motion& motion, const ContactTruth& truth, double noise_std,
                                Normal* normal, int num_samples = 100, double dt = 1e-3) {
  DataPack pack;
  pack.seq = seq;
  pack.run_id = 1;
  pack.dt = dt;
  pack.plant = PlantKind::kHuntCrossley;
  pack.num_samples = num_samples;
  pack.num_inputs = 2;
  const double omega = 6.283185307179586 * motion.hertz;
  for (int n = 0; n < num_samples; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const double t = static_cast<double>((seq - 1) * num_samples + n) * pack.dt;
    const double x = motion.depth + motion.swing * std::sin(omega * t + motion.phase);
    const double v = motion.swing * omega * std::cos(omega * t + motion.phase);
    pack.u[i] = {x, v, 0.0, 0.0};
    const double force = x >= 0.0 ? std::pow(x, truth.p) * (truth.k + truth.b * v) : 0.0;
    pack.y[i] = force + noise_std * (*normal)();
    pack.t_last_s = t;
  }
  return pack;
}

}  // namespace armcmc::test
