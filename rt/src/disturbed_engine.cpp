#include "armcmc/rt/disturbed_engine.hpp"

#include "armcmc/rt/warm_up.hpp"

namespace armcmc::rt {
namespace {

/// A wrong plant without noise, repeated until the posterior has nearly no width left.
constexpr double kWrongScale = 0.5;
constexpr int kRepeats = 8;

}  // namespace

Status DisturbedEngine::Adjust(const DataPack& pack, Nanos deadline_ns, ClockRef clock, int slot) noexcept {
  // Without a clock it is the warm-up, which meets no faults.
  if (clock.read == nullptr) return engine_->Adjust(pack, deadline_ns, clock, slot);
  pack_[static_cast<std::size_t>(slot)] = pack.seq;
  if (injection_->CutsDraws(pack.seq)) deadline_ns = clock.Now();
  Status status = Status::kOk;
  if (injection_->Collapses(pack.seq)) {
    for (int i = 0; i < kRepeats; ++i) {
      wrong_ = SyntheticPack(pack_format(), i);
      wrong_.seq = pack.seq;
      wrong_.run_id = pack.run_id;
      wrong_.t_last_ns = pack.t_last_ns;
      wrong_.t_last_s = pack.t_last_s;
      for (std::size_t n = 0; n < static_cast<std::size_t>(wrong_.num_samples); ++n) wrong_.y[n] *= kWrongScale;
      status = engine_->Adjust(wrong_, deadline_ns, clock, slot);
    }
  } else {
    status = engine_->Adjust(pack, deadline_ns, clock, slot);
  }
  injection_->Disturb(Stage::kAdjust, pack.seq);
  return status;
}

void DisturbedEngine::Execute(int slot, Estimate* estimate) noexcept {
  engine_->Execute(slot, estimate);
  injection_->Disturb(Stage::kExecute, pack_[static_cast<std::size_t>(slot)]);
}

}  // namespace armcmc::rt
