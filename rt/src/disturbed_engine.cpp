#include "armcmc/rt/disturbed_engine.hpp"

namespace armcmc::rt {
namespace {

/// A wrong plant, told often enough that the posterior has nearly no width left.
constexpr double kWrongScale = 1.6;
constexpr int kRepeats = 8;

}  // namespace

Status DisturbedEngine::Adjust(const DataPack& pack, Nanos deadline_ns, ClockRef clock, int slot) noexcept {
  // Without a clock it is the warm-up, which meets no faults.
  if (clock.read == nullptr) return engine_->Adjust(pack, deadline_ns, clock, slot);
  pack_[static_cast<std::size_t>(slot)] = pack.seq;
  if (injection_->Squeezes(pack.seq)) deadline_ns = clock.Now();
  Status status = Status::kOk;
  if (injection_->Collapses(pack.seq)) {
    wrong_ = pack;
    for (std::size_t n = 0; n < static_cast<std::size_t>(pack.num_samples); ++n) wrong_.y[n] *= kWrongScale;
    for (int i = 0; i < kRepeats; ++i) status = engine_->Adjust(wrong_, deadline_ns, clock, slot);
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
