#include "armcmc/bench/press.hpp"

#include <cmath>
#include <numbers>

#include "armcmc/models/registry.hpp"
#include "armcmc/rng.hpp"

namespace armcmc::bench {

const std::string& PressedPlant() {
  static const std::string name = DefaultModel();
  return name;
}

DataPack MakePress(const Press& press, int index, int samples, std::uint64_t seed) {
  constexpr double kDt = 1e-3;
  DataPack pack;
  pack.seq = index + 1;
  pack.run_id = 1;
  pack.dt = kDt;
  pack.plant = CompiledModels()[static_cast<std::size_t>(FindModel(PressedPlant()))]->plant;
  pack.num_samples = samples;
  pack.num_inputs = 2;
  RandomStream stream(seed, static_cast<std::uint64_t>(index), 0);
  const double rate = 2.0 * std::numbers::pi * press.frequency;
  for (int n = 0; n < samples; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const double t = kDt * (index * samples + n);
    const double x = press.depth + press.stroke * std::sin(rate * t), v = press.stroke * rate * std::cos(rate * t);
    const double radius = std::sqrt(-2.0 * std::log(stream.Uniform()));
    const double normal = radius * std::cos(2.0 * std::numbers::pi * stream.Uniform());
    pack.u[i] = {x, v};
    pack.y[i] = (press.stiffness + press.damping * v) * std::pow(x, press.exponent) + press.noise * normal;
    pack.t_last_s = t;
  }
  pack.t_last_ns = static_cast<Nanos>(1e9 * pack.t_last_s);
  return pack;
}

}  // namespace armcmc::bench
