#include "armcmc/interleaved_estimator.hpp"

namespace armcmc {

InterleavedEstimator::InterleavedEstimator(const EstimatorSettings& settings) {
  estimators_.push_back(std::make_unique<Estimator>(settings));
  EstimatorSettings others = settings;
  others.gap_watch.enabled = false;
  for (int j = 1; j < settings.overlap; ++j)
    estimators_.push_back(std::make_unique<Estimator>(others, *estimators_.front()));
}

int InterleavedEstimator::TurnOf(std::int64_t seq) const noexcept {
  // A number below 1 is invalid for a pack, and is rejected by the recursion that receives it.
  return seq > 0 ? static_cast<int>(seq % overlap()) : 0;
}

Status InterleavedEstimator::Draw(const DataPack& pack, Nanos deadline_ns, ClockRef clock, AdjustResult* result,
                                  const DrawLimits& limits) noexcept {
  const int turn = TurnOf(pack.seq);
  if (turn != turn_) recursion(turn_).Remember(clock);  // its draws are in the shared scratch
  turn_ = turn;
  return recursion(turn).Draw(pack, deadline_ns, clock, result, limits);
}

void InterleavedEstimator::Remember(ClockRef clock) noexcept {
  recursion(turn_).Remember(clock);
  if (overlap() > 1) recursion((turn_ + 1) % overlap()).Prefetch();  // nobody waits now, and its turn is next
}

Status InterleavedEstimator::Adjust(const DataPack& pack, Nanos deadline_ns, ClockRef clock, AdjustResult* result,
                                    const DrawLimits& limits) noexcept {
  const Status status = Draw(pack, deadline_ns, clock, result, limits);
  Remember(clock);
  return status;
}

void InterleavedEstimator::Execute(const AdjustResult& result, Estimate* estimate) noexcept {
  Estimator& estimator = Of(result.pack.seq);
  estimator.Execute(result, estimate);
  if (&estimator != estimators_.front().get()) estimate->gap = first().gap();
}

void InterleavedEstimator::Forecast(const AdjustResult& result, PackForecast* forecast) noexcept {
  Of(result.pack.seq).Forecast(result, forecast);
}

void InterleavedEstimator::Reset() noexcept {
  for (const auto& estimator : estimators_) estimator->Reset();
}

}  // namespace armcmc
