#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/adjust_result.hpp"
#include "armcmc/bench/press.hpp"
#include "armcmc/estimator.hpp"
#include "steps.hpp"

namespace armcmc::bench {
namespace {

constexpr int kReplicates = 200, kSamples = 100;

/// Packs before the one that counts, and that one.
struct Case {
  const char* name;
  int learnt;  ///< Packs that the posterior has seen before.
  Press before, now;
};

std::vector<Case> Cases() {
  Press rich, poor, changed;
  poor.depth = 0.4;
  poor.stroke = 0.02;
  changed.stiffness = 2.0;
  return {{"cold", 0, rich, rich}, {"warm", 8, rich, rich}, {"ridge", 0, poor, poor}, {"change", 8, rich, changed}};
}

/// Variance over the replicates of one estimate of one parameter. Differences from the first keep a narrow spread from
/// cancelling.
struct Spread {
  int count = 0;
  double first = 0.0, sum = 0.0, square = 0.0;
  void Add(double x) {
    if (count++ == 0) first = x;
    sum += x - first;
    square += (x - first) * (x - first);
  }
  [[nodiscard]] double Mean() const { return first + sum / count; }
  [[nodiscard]] double Variance() const { return (square - sum * sum / count) / (count - 1); }
};

/// Effective number of draws = posterior variance / variance of the estimated mean over replicates that differ in the
/// seed of the draws of one pack alone; of the parameter that has fewest. A spread does not see an error that all
/// replicates share, so `bias` is how far the published mean lies from that of the chain, which no control variate has
/// touched, over all replicates: posterior standard deviations, of the parameter where it is largest.
void EffectiveDraws(benchmark::State& state, const Case& what) {
  EstimatorSettings settings = BuiltinSettings(PressedPlant());
  settings.noise[0].std = what.now.noise;
  Estimator teacher(settings);
  const auto result = teacher.MakeResult();
  Estimate estimate;
  for (int k = 0; k < what.learnt; ++k) {
    (void)teacher.Adjust(MakePress(what.before, k, kSamples, 7), std::numeric_limits<Nanos>::max(), ClockRef(),
                         result.get());
    teacher.Execute(*result, &estimate);
  }
  std::vector<std::byte> adjusted(Estimator::kSnapshotBytes), executed(Estimator::kSnapshotBytes);
  adjusted.resize(teacher.SaveAdjusted(adjusted));
  executed.resize(teacher.SaveExecuted(executed));
  const DataPack pack = MakePress(what.now, what.learnt, kSamples, 7);

  std::array<Spread, 3> chain, weighted;
  std::array<double, 3> variance{};
  double seconds = 0.0;
  for (auto _ : state) {
    for (int r = 0; r < kReplicates; ++r) {
      settings.sampler.seed = 1000 + static_cast<std::uint64_t>(r);
      Estimator estimator(settings);
      if (what.learnt > 0 && !estimator.Restore(adjusted, executed)) {
        state.SkipWithError("the posterior before the pack cannot be restored");
        return;
      }
      const auto start = std::chrono::steady_clock::now();
      (void)estimator.Adjust(pack, std::numeric_limits<Nanos>::max(), ClockRef(), result.get());
      estimator.Execute(*result, &estimate);
      seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      for (std::size_t d = 0; d < chain.size(); ++d) {
        const MarginalSummary& m = estimate.modes[0].marginal[d];
        chain[d].Add(m.chain_mean);
        weighted[d].Add(m.ar_ap);
        variance[d] += m.is_sd * m.is_sd / kReplicates;
      }
    }
  }
  const auto fewest = [&](const std::array<Spread, 3>& spread) {
    double least = HUGE_VAL;
    for (std::size_t d = 0; d < spread.size(); ++d) least = std::min(least, variance[d] / spread[d].Variance());
    return least;
  };
  double bias = 0.0;
  for (std::size_t d = 0; d < chain.size(); ++d)
    bias = std::max(bias, std::abs(weighted[d].Mean() - chain[d].Mean()) / std::sqrt(variance[d]));
  const double ms = 1e3 * seconds / kReplicates;
  state.counters["chain"] = fewest(chain);
  state.counters["weighted"] = fewest(weighted);
  state.counters["bias"] = bias;
  state.counters["step_ms"] = ms;
  state.counters["weighted_per_ms"] = fewest(weighted) / ms;
}

}  // namespace

void RegisterQuality() {
  for (const Case& what : Cases())
    benchmark::RegisterBenchmark((std::string("BM_EffectiveDraws/") + what.name).c_str(),
                                 [what](benchmark::State& state) { EffectiveDraws(state, what); })
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
}

}  // namespace armcmc::bench
