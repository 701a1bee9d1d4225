#include "armcmc/rt/release_grid.hpp"

#include <algorithm>
#include <limits>

namespace armcmc::rt {

void ReleaseGrid::ClearWindow() noexcept {
  window_min_ns_ = std::numeric_limits<Nanos>::max();
  window_size_ = 0;
}

ReleaseGrid::Point ReleaseGrid::Lock(Nanos arrival_ns) noexcept ARMCMC_NONBLOCKING {
  locked_ = true;
  proposed_ = false;
  left_packs_ = 0;
  due_ns_ = arrival_ns;
  arrival_ns_ = arrival_ns;
  ClearWindow();
  return {arrival_ns, 0};
}

ReleaseGrid::Point ReleaseGrid::OnPack(std::int64_t steps, Nanos arrival_ns) noexcept ARMCMC_NONBLOCKING {
  const Nanos pause_ns = arrival_ns - arrival_ns_;
  if (proposed_) {
    proposed_ = false;
    if (pause_ns > steps * period_ns_ - period_ns_ / 2) {
      if (left_packs_ == 0) left_due_ns_ = due_ns_;
      left_packs_ = settling_packs_ + 1;
      due_ns_ = arrival_ns_;
    }
  }
  arrival_ns_ = arrival_ns;
  due_ns_ += steps * period_ns_;
  if (left_packs_ > 0) {
    --left_packs_;
    left_due_ns_ += steps * period_ns_;
    if (arrival_ns < due_ns_ - period_ns_ / 2 && arrival_ns > left_due_ns_) {
      due_ns_ = left_due_ns_;
      left_packs_ = 0;
    }
  }
  const Nanos lateness_ns = arrival_ns - due_ns_;
  const Nanos unsettled_ns = left_packs_ > 0 ? std::max<Nanos>(0, arrival_ns - left_due_ns_) : 0;
  if (lateness_ns <= 0) {
    due_ns_ = arrival_ns;
    ClearWindow();
    return {arrival_ns, 0, unsettled_ns};
  }
  const Point point{due_ns_, lateness_ns, unsettled_ns};
  if (pause_ns < steps * period_ns_ / 2) {
    ClearWindow();  // catching up: says nothing about the phase
    return point;
  }
  if (lateness_ns >= period_ns_) {
    proposed_ = true;
    ClearWindow();
    return point;
  }
  window_min_ns_ = std::min(window_min_ns_, lateness_ns);
  if (++window_size_ == kWindow) {
    due_ns_ += window_min_ns_;
    ClearWindow();
  }
  return point;
}

}  // namespace armcmc::rt
