#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "armcmc/nonblocking.hpp"

namespace armcmc::rt {

/// Histogram of non-negative integers (latencies in ns, numbers of draws) with 32 buckets per factor of two.
///
/// Fixed size, no allocation. A quantile is the mean of the values in its bucket: within 3.2 % of the exact order
/// statistic, and exact when the bucket holds one value only. The maximum is exact.
/// One writer; readers only after the writer has finished.
class LogHistogram {
 public:
  /// @rt O(1). Negative values count as 0.
  void Add(std::int64_t value) noexcept ARMCMC_NONBLOCKING {
    const std::uint64_t v = value > 0 ? static_cast<std::uint64_t>(value) : 0;
    Bucket& bucket = buckets_[Index(v)];
    ++bucket.count;
    bucket.sum += static_cast<double>(v);
    ++count_;
    max_ = std::max(max_, v);
    min_ = std::min(min_, v);
  }

  void Merge(const LogHistogram& other) noexcept {
    for (std::size_t i = 0; i < kBuckets; ++i) {
      buckets_[i].count += other.buckets_[i].count;
      buckets_[i].sum += other.buckets_[i].sum;
    }
    count_ += other.count_;
    max_ = std::max(max_, other.max_);
    min_ = std::min(min_, other.min_);
  }

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] double max() const noexcept { return static_cast<double>(max_); }
  [[nodiscard]] double min() const noexcept { return count_ == 0 ? 0.0 : static_cast<double>(min_); }

  /// Value of rank ceil(q count), q in (0, 1]; 0 when empty.
  [[nodiscard]] double Quantile(double q) const noexcept {
    if (count_ == 0) return 0.0;
    const double rank = std::clamp(std::ceil(q * static_cast<double>(count_)), 1.0, static_cast<double>(count_));
    double seen = 0.0;
    for (const Bucket& bucket : buckets_) {
      seen += static_cast<double>(bucket.count);
      if (seen >= rank) return bucket.sum / static_cast<double>(bucket.count);
    }
    return max();
  }

 private:
  static constexpr unsigned kSubBits = 5;
  static constexpr std::uint64_t kSub = 1U << kSubBits;
  static constexpr std::size_t kBuckets = (64 - kSubBits + 1) * kSub;

  struct Bucket {
    std::uint64_t count = 0;
    double sum = 0.0;
  };

  [[nodiscard]] static std::size_t Index(std::uint64_t v) noexcept {
    if (v < kSub) return static_cast<std::size_t>(v);
    const unsigned shift = static_cast<unsigned>(std::bit_width(v)) - 1U - kSubBits;
    return static_cast<std::size_t>((shift + 1U) * kSub + ((v >> shift) - kSub));
  }

  std::array<Bucket, kBuckets> buckets_{};
  std::uint64_t count_ = 0;
  std::uint64_t max_ = 0;
  std::uint64_t min_ = ~std::uint64_t{0};
};

}  // namespace armcmc::rt
