#include "armcmc/replay/replay.hpp"

#include <chrono>
#include <limits>
#include <memory>

#include "armcmc/adjust_result.hpp"

namespace armcmc::replay {
namespace {

using OnEstimate = std::function<void(const RecordedPack&, const Estimate&)>;

/// @param fresh  Share of the samples of a pack that no pack before it has.
template <typename AnyEstimator>
ReplaySummary Run(PackSource* source, AnyEstimator* estimator, double fresh, const OnEstimate& on_estimate,
                  PackForecast* forecast) {
  using Clock = std::chrono::steady_clock;
  constexpr Nanos kNever = std::numeric_limits<Nanos>::max();
  const std::unique_ptr<AdjustResult> result = estimator->MakeResult();
  const auto recorded = std::make_unique<RecordedPack>();
  const auto estimate = std::make_unique<Estimate>();
  ReplaySummary summary;
  Clock::duration compute{};
  while (source->Next(recorded.get())) {
    const Clock::time_point start = Clock::now();
    const Status status = estimator->Adjust(recorded->pack, kNever, ClockRef{}, result.get(), recorded->limits);
    if (status == Status::kBadPack) {
      ++summary.refused;
      continue;
    }
    if (forecast != nullptr) estimator->Forecast(*result, forecast);
    estimator->Execute(*result, estimate.get());
    const Clock::duration took = Clock::now() - start;
    compute += took;
    summary.pack_compute_s.push_back(std::chrono::duration<double>(took).count());
    ++summary.packs;
    summary.data_s += fresh * recorded->pack.num_samples * recorded->pack.dt;
    bool updated = false, modified = false, truncated = false;
    for (const ModeEstimate& mode : estimate->modes) {
      updated = updated || mode.updated;
      modified = modified || (mode.updated && mode.decision == Decision::kModification);
      truncated = truncated || (mode.updated && mode.truncated);
    }
    summary.held += updated ? 0 : 1;
    summary.modifications += modified ? 1 : 0;
    summary.truncated += truncated ? 1 : 0;
    on_estimate(*recorded, *estimate);
  }
  summary.compute_s = std::chrono::duration<double>(compute).count();
  summary.last = *estimate;
  return summary;
}

}  // namespace

ReplaySummary Replay(PackSource* source, Estimator* estimator, const OnEstimate& on_estimate, PackForecast* forecast) {
  return Run(source, estimator, 1.0, on_estimate, forecast);
}

ReplaySummary Replay(PackSource* source, InterleavedEstimator* estimator, const OnEstimate& on_estimate,
                     PackForecast* forecast) {
  return Run(source, estimator, 1.0 / estimator->overlap(), on_estimate, forecast);
}

}  // namespace armcmc::replay
