#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "armcmc/nonblocking.hpp"

namespace armcmc::rt {

/// Histogram of non-negative integers (latencies in ns, numbers of draws) with 32 buckets per factor of two, after
/// HdrHistogram (G. Tene).
///
/// A value v < 32 has a bucket of its own. Beyond that the bucket is given by the position of the highest bit and the
/// five bits after it, so that its width is at most v / 32. Each bucket keeps count and sum: a quantile is the mean of
/// the values in its bucket, within 3.2 % of the exact order statistic, and exact if the bucket holds one value only.
/// Minimum and maximum are exact.
///
/// Fixed size (about 30 kB), no allocation. One writer; readers only after the writer has finished.
/// @code
/// LogHistogram latency;                              // ns
/// latency.Add(end_ns - start_ns);                    // in the stage
/// report["p99_ms"] = latency.Quantile(0.99) / 1e6;   // after the stage has ended
/// @endcode
class LogHistogram {
 public:
  /// Counts a value; negative ones count as 0.
  /// @rt No heap, no lock, no throw. O(1).
  void Add(std::int64_t value) noexcept ARMCMC_NONBLOCKING {
    const std::uint64_t v = value > 0 ? static_cast<std::uint64_t>(value) : 0;
    Bucket& bucket = buckets_[Index(v)];
    ++bucket.count;
    bucket.sum += static_cast<double>(v);
    ++count_;
    max_ = std::max(max_, v);
    min_ = std::min(min_, v);
  }

  /// Adds the values of another histogram, as if each had been added here.
  /// @pre Neither histogram is being written. @rt No heap, no lock, no throw. O(buckets).
  void Merge(const LogHistogram& other) noexcept {
    for (std::size_t i = 0; i < kBuckets; ++i) {
      buckets_[i].count += other.buckets_[i].count;
      buckets_[i].sum += other.buckets_[i].sum;
    }
    count_ += other.count_;
    max_ = std::max(max_, other.max_);
    min_ = std::min(min_, other.min_);
  }

  /// Number of values. @rt This and the following two: O(1).
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  /// Largest value, in the unit of the values; 0 if there is none. Exact below 2^53.
  [[nodiscard]] double max() const noexcept { return static_cast<double>(max_); }
  /// Smallest value; 0 if there is none. As max().
  [[nodiscard]] double min() const noexcept { return count_ == 0 ? 0.0 : static_cast<double>(min_); }

  /// Quantile: the value of rank ceil(q count), as the mean of its bucket.
  /// @param q  In (0, 1]; 1 is within the bucket of the maximum.
  /// @return in the unit of the values; 0 if there are no values.
  /// @pre The writer has finished. @rt No heap, no lock, no throw. O(buckets).
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
  /// Buckets per factor of two, as a power of two: 2^5 = 32.
  static constexpr unsigned kSubBits = 5;
  /// Buckets per factor of two.
  static constexpr std::uint64_t kSub = 1U << kSubBits;
  /// One row of kSub for the values below kSub, and one for each higher position of the highest bit.
  static constexpr std::size_t kBuckets = (64 - kSubBits + 1) * kSub;

  /// Values of one bucket; the sum is a double, since sums of ns may exceed 64 bits.
  struct Bucket {
    std::uint64_t count = 0;
    double sum = 0.0;
  };

  /// Bucket of a value: v itself below 32, else 32 (shift + 1) + the five bits after the highest one, with shift the
  /// number of lower bits that are ignored.
  [[nodiscard]] static std::size_t Index(std::uint64_t v) noexcept {
    if (v < kSub) return static_cast<std::size_t>(v);
    const unsigned shift = static_cast<unsigned>(std::bit_width(v)) - 1U - kSubBits;
    return static_cast<std::size_t>((shift + 1U) * kSub + ((v >> shift) - kSub));
  }

  /// State of the histogram; min_ is the largest integer while it is empty.
  std::array<Bucket, kBuckets> buckets_{};
  std::uint64_t count_ = 0;
  std::uint64_t max_ = 0;
  std::uint64_t min_ = ~std::uint64_t{0};
};

}  // namespace armcmc::rt
