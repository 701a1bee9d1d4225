#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace armcmc::watch {

/// The last values of one number, oldest first; NaN stands for a step without one.
class History {
 public:
  static constexpr std::size_t kCapacity = 120;

  void Add(double value) noexcept {
    values_[next_ % kCapacity] = value;
    ++next_;
  }

  /// At most n of the newest values.
  [[nodiscard]] std::vector<double> Newest(std::size_t n) const {
    const std::size_t held = next_ < kCapacity ? next_ : kCapacity;
    const std::size_t count = n < held ? n : held;
    std::vector<double> out(count);
    for (std::size_t i = 0; i < count; ++i) out[i] = values_[(next_ - count + i) % kCapacity];
    return out;
  }

 private:
  std::array<double, kCapacity> values_{};
  std::size_t next_ = 0;
};

}  // namespace armcmc::watch
