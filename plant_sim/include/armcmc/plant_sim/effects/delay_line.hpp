#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace armcmc::plant_sim {

/// Pure dead time, linear between samples. Before the first sample the signal was what it was there.
class DelayLine {
 public:
  DelayLine(double delay_s, double dt) : samples_(delay_s / dt) {
    history_.resize(static_cast<std::size_t>(samples_) + 2);
  }
  double Step(double u) noexcept {
    if (!started_) std::fill(history_.begin(), history_.end(), u);
    started_ = true;
    head_ = (head_ + 1) % history_.size();
    history_[head_] = u;
    const double whole = std::floor(samples_);
    const auto back = static_cast<std::size_t>(whole);
    const double late = Back(back + 1), early = Back(back);
    return early + (samples_ - whole) * (late - early);
  }

 private:
  [[nodiscard]] double Back(std::size_t n) const noexcept {
    return history_[(head_ + history_.size() - n) % history_.size()];
  }
  double samples_;
  std::vector<double> history_;
  std::size_t head_ = 0;
  bool started_ = false;
};

}  // namespace armcmc::plant_sim
