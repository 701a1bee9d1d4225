#pragma once

#include <array>
#include <random>

#include "armcmc/plant/program.hpp"
#include "core/estimator_rig.hpp"

namespace armcmc::test {

/// One sample of any plant: inputs, output.
struct PlantSample {
  std::array<double, kMaxPackInputs> u{};
  double y = 0.0;
};

/// Pack `seq` of a run: sample_at(t) from t = dt on.
template <class SampleAt>
DataPack DescribedPack(const PlantProgram& plant, std::int64_t seq, const SampleAt& sample_at, int num_samples = 100,
                       double dt = 1e-3) {
  DataPack pack = BlankPack(PlantNumber::kDescribed, seq, num_samples, dt);
  pack.num_inputs = plant.info().num_inputs;
  pack.fingerprint = plant.plant().fingerprint();
  pack.t_last_s = static_cast<double>(seq * num_samples) * dt;
  for (int n = 0; n < num_samples; ++n) {
    const double t = pack.t_last_s - (num_samples - 1 - n) * dt;
    const PlantSample sample = sample_at(t);
    pack.u[static_cast<std::size_t>(n)] = sample.u;
    pack.y[static_cast<std::size_t>(n)] = sample.y;
  }
  return pack;
}

class GaussianNoise {
 public:
  explicit GaussianNoise(double sd) : law_(0.0, sd) {}
  double operator()() { return law_(random_); }

 private:
  std::mt19937_64 random_{11};
  std::normal_distribution<double> law_;
};

}  // namespace armcmc::test
