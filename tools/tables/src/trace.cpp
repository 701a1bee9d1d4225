#include "armcmc/tables/trace.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include "armcmc/adjust_result.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/parameter_space.hpp"

namespace armcmc::tables {
namespace {

/// Central intervals of a parameter from the visits of the chain.
void Intervals(const ModeDraws& draws, const ParameterSpace& space, std::size_t d, ModeTrace* out) {
  std::vector<std::pair<double, double>> values;
  double total = 0.0;
  for (int k = 0; k < draws.draws; ++k) {
    if (draws.visits[k] == 0) continue;
    values.emplace_back(space.Theta(static_cast<int>(d), draws.AtEnd(static_cast<int>(d), k)), draws.visits[k]);
    total += draws.visits[k];
  }
  std::sort(values.begin(), values.end());
  const auto quantile = [&](double level) {
    double below = 0.0;
    for (const auto& [value, weight] : values) {
      below += weight;
      if (below >= level * total) return value;
    }
    return values.back().first;
  };
  for (std::size_t l = 0; l < kLevels.size(); ++l)
    out->interval[l][d] = {quantile(0.5 - 0.5 * kLevels[l]), quantile(0.5 + 0.5 * kLevels[l])};
}

}  // namespace

const PackTrace* Trace::ShownAt(std::size_t sample) const {
  const auto k = static_cast<std::size_t>(sample / static_cast<std::size_t>(pack_samples));
  return k >= 2 && k - 2 < packs.size() ? &packs[k - 2] : nullptr;
}

Trace RunMethod(const Recording& recording, const MethodSpec& spec) {
  using Clock = std::chrono::steady_clock;
  Estimator estimator(spec.settings);
  const auto result = estimator.MakeResult();
  const auto estimate = std::make_unique<Estimate>();
  const auto pack = std::make_unique<DataPack>();
  Trace trace{spec.key, spec.label, spec.pack_samples, true, true, {}};
  const auto num_parameters = static_cast<std::size_t>(spec.settings.num_parameters);
  const auto num_modes = static_cast<std::size_t>(estimator.num_modes());
  PackTrace now;
  const int packs = static_cast<int>(recording.size() - 1) / spec.pack_samples;
  for (int k = 1; k <= packs; ++k) {
    FillPack(recording, k, spec.pack_samples, pack.get());
    const Clock::time_point start = Clock::now();
    (void)estimator.Adjust(*pack, 0, ClockRef{}, result.get());
    estimator.Execute(*result, estimate.get());
    now.ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    for (std::size_t m = 0; m < num_modes; ++m) {
      const ModeEstimate& mode = estimate->modes[m];
      ModeTrace& state = now.modes[m];
      state.updated = mode.updated;
      state.known = mode.known;
      state.any = state.any || mode.updated || mode.known;
      if (!state.any) continue;
      state.p_drifted = mode.p_drifted;
      const ParameterSpace space(spec.settings, spec.settings.noise[m]);
      for (std::size_t d = 0; d < num_parameters; ++d) {
        state.ap[d] = mode.marginal[d].ar_ap;
        // The mode of a posterior that knows nothing is an accident.
        state.map[d] = mode.known ? mode.marginal[d].ar_map : mode.marginal[d].ar_ap;
        state.sd[d] = mode.marginal[d].sd;
        state.drift_rate[d] = mode.drift_rate[d];
        if (mode.updated) Intervals(result->modes[m], space, d, &state);
      }
    }
    const ModeEstimate& acting = estimate->modes[static_cast<std::size_t>(estimate->report_mode)];
    now.decision = acting.updated ? static_cast<int>(acting.decision) : 0;
    now.zeta = acting.zeta;
    now.lambda = acting.lambda;
    now.draws = acting.draws;
    for (std::size_t d = 0; d < num_parameters; ++d) now.marginal[d] = estimate->modes[0].marginal[d];
    trace.packs.push_back(now);
  }
  return trace;
}

}  // namespace armcmc::tables
