#include <benchmark/benchmark.h>

#include <cmath>
#include <string>
#include <vector>

#include "armcmc/bench/press.hpp"
#include "steps.hpp"

namespace armcmc::bench {
namespace {

struct Candidate {
  double stiffness, damping, exponent;
};

/// Gaussian log-likelihood as the formula reads, up to a constant.
double LogLikelihood(const DataPack& pack, const Candidate& c, double noise) {
  double sum = 0.0;
  for (int n = 0; n < pack.num_samples; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const double predicted = (c.stiffness + c.damping * pack.u[i][1]) * std::pow(pack.u[i][0], c.exponent);
    const double z = (pack.y[i] - predicted) / noise;
    sum -= 0.5 * z * z;
  }
  return sum;
}

void NaiveLoop(benchmark::State& state, int draws, int samples) {
  const Press press;
  const DataPack pack = MakePress(press, 0, samples, 1);
  std::vector<Candidate> candidates(static_cast<std::size_t>(draws));
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const double wave = 1e-3 * std::sin(0.37 * static_cast<double>(k));
    candidates[k] = {press.stiffness * (1.0 + wave), press.damping * (1.0 - wave), press.exponent * (1.0 + 0.5 * wave)};
  }
  for (auto _ : state) {
    double sum = 0.0;
    for (const Candidate& c : candidates) sum += LogLikelihood(pack, c, press.noise);
    benchmark::DoNotOptimize(sum);
  }
}

}  // namespace

void RegisterNaiveLoop(int draws, int samples) {
  benchmark::RegisterBenchmark(("BM_NaiveLoop/" + std::to_string(draws) + "/" + std::to_string(samples)).c_str(),
                               [=](benchmark::State& state) { NaiveLoop(state, draws, samples); })
      ->Unit(benchmark::kMillisecond);
}

}  // namespace armcmc::bench
