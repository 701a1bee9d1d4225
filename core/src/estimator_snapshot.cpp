// The state from which an estimator continues after a restart.

#include "armcmc/snapshot.hpp"

#include "estimator_impl.hpp"

namespace armcmc {

std::size_t Estimator::SaveAdjusted(std::span<std::byte> bytes) const noexcept {
  SnapshotWriter out(bytes);
  for (std::size_t m = 0; m < impl_->samplers.size(); ++m) {
    const ModeMemory& memory = *impl_->memories[m];
    memory.slot[memory.current].Save(&out);
    impl_->samplers[m]->transition().Save(&out);
  }
  if (!impl_->state_filter.empty()) {
    out.PutRow(impl_->state_mean.data(), impl_->state_mean.size());
    out.PutRow(impl_->state_sd.data(), impl_->state_sd.size());
    out.Put(impl_->state_noise);
  }
  for (const auto& sampler : impl_->samplers) sampler->drift().Save(&out);
  return out.size();
}

std::size_t Estimator::SaveExecuted(std::span<std::byte> bytes) const noexcept {
  const Impl& s = *impl_;
  SnapshotWriter out(bytes);
  out.Put(std::int64_t{s.report_mode});
  for (std::size_t m = 0; m < static_cast<std::size_t>(s.info.num_modes); ++m) {
    out.PutFlag(s.known_draws[m]);
    s.last_estimates[m].Save(s.info.num_reported, &out);
    // The band is drawn at the first update, and read once something is known.
    for (std::size_t d = 0; s.last_estimates[m].known && d < static_cast<std::size_t>(s.info.num_parameters); ++d)
      out.PutRow(s.band_theta[m].value[d].data(), kTileLanes);
    for (const ShownEstimates& shown : s.shown) {
      out.PutFlag(shown.known[m]);
      out.PutRow(shown.theta[m].data(), static_cast<std::size_t>(s.info.num_parameters));
    }
  }
  if (s.gap_watch) s.gap_watch->Save(&out);
  if (s.output_watch) s.output_watch->Save(&out);
  for (std::size_t m = 0; m < static_cast<std::size_t>(s.info.num_modes); ++m)
    s.last_estimates[m].SaveDrift(s.info.num_reported, &out);
  return out.size();
}

bool Estimator::Restore(std::span<const std::byte> adjusted, std::span<const std::byte> executed) noexcept {
  Impl& s = *impl_;
  Reset();
  if (!s.filters.empty()) return false;  // baselines have no snapshot
  SnapshotReader posterior(adjusted);
  for (std::size_t m = 0; m < s.memories.size(); ++m) {
    s.memories[m]->current = 0;
    s.memories[m]->slot[0].Restore(s.samplers[m]->space().dim, s.samplers[m]->shared_table(), &posterior);
    s.samplers[m]->transition().Restore(&posterior);
  }
  // Older snapshots end here: states are then linearised about the prior's mean again.
  if (!s.state_filter.empty() && !posterior.finished()) {
    posterior.Row(s.state_mean.data(), s.state_mean.size());
    posterior.Row(s.state_sd.data(), s.state_sd.size());
    s.state_noise = posterior.Number();
    posterior.Require(s.state_noise > 0.0);
  }
  // Older ones end here: the drift of the parameters is then estimated anew.
  if (!posterior.finished())
    for (const auto& sampler : s.samplers) sampler->drift().Restore(&posterior);
  SnapshotReader display(executed);
  s.report_mode = static_cast<int>(display.Integer(0, s.info.num_modes - 1));
  for (std::size_t m = 0; m < s.memories.size(); ++m) {
    s.known_draws[m] = display.Flag();
    s.last_estimates[m].Restore(s.info.num_reported, &display);
    for (std::size_t d = 0; s.last_estimates[m].known && d < static_cast<std::size_t>(s.info.num_parameters); ++d)
      display.Row(s.band_theta[m].value[d].data(), kTileLanes);
    for (ShownEstimates& shown : s.shown) {
      shown.known[m] = display.Flag();
      display.Row(shown.theta[m].data(), static_cast<std::size_t>(s.info.num_parameters));
    }
  }
  // Older snapshots of described plants without a watch end here.
  if (s.gap_watch && (s.info.described == nullptr || !display.finished())) s.gap_watch->Restore(&display);
  if (s.output_watch) s.output_watch->Restore(&display);
  // Older ones contain no drift.
  for (std::size_t m = 0; !display.finished() && m < s.memories.size(); ++m)
    s.last_estimates[m].RestoreDrift(s.info.num_reported, &display);
  if (posterior.finished() && display.finished()) return true;
  Reset();
  return false;
}

}  // namespace armcmc
