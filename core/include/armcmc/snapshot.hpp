#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "armcmc/nonblocking.hpp"
#include "armcmc/settings.hpp"

namespace armcmc {

/// Writes plain values one after another into memory of fixed size, for the state that an estimator saves
/// (see Estimator::kSnapshotBytes). If the memory is too small, nothing is written beyond it, and size() is 0.
///
/// Byte order and layout are those of the machine: a snapshot is read on the machine that wrote it. The file around it
/// holds a version, SnapshotIdentity() and a checksum.
class SnapshotWriter {
 public:
  /// @param out  Memory to fill; must outlive the writer.
  explicit SnapshotWriter(std::span<std::byte> out) noexcept : out_(out) {}

  /// Appends an arithmetic value. @rt No heap, no lock, no throw. O(1).
  template <class T>
  void Put(const T& value) noexcept ARMCMC_NONBLOCKING {
    PutRow(&value, 1);
  }
  /// Appends a bool as one byte, 0 or 1.
  void PutFlag(bool flag) noexcept ARMCMC_NONBLOCKING { Put(static_cast<std::uint8_t>(flag ? 1 : 0)); }

  /// Appends `count` arithmetic values (not bool), as they are in memory. @rt O(count).
  template <class T>
  void PutRow(const T* values, std::size_t count) noexcept ARMCMC_NONBLOCKING {
    static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>);
    const std::size_t bytes = count * sizeof(T);
    if (bytes > out_.size() - size_) {
      fits_ = false;
      return;
    }
    std::memcpy(out_.data() + size_, values, bytes);
    size_ += bytes;
  }

  /// Bytes written, or 0 when the memory was too small for all.
  [[nodiscard]] std::size_t size() const noexcept { return fits_ ? size_ : 0; }

 private:
  std::span<std::byte> out_;
  std::size_t size_ = 0;
  bool fits_ = true;
};

/// Reads what a SnapshotWriter wrote, without trusting it: after the first value that is missing, not finite or out of
/// its range, good() is false from then on, and every value reads as the lowest one allowed, or zero. So a reader can
/// read everything first, and check once.
class SnapshotReader {
 public:
  /// @param in  Bytes of a snapshot; must outlive the reader.
  explicit SnapshotReader(std::span<const std::byte> in) noexcept : in_(in) {}

  /// Next 64-bit integer.
  /// @param least, most  Allowed range. @return `least` if the value is outside it or missing.
  [[nodiscard]] std::int64_t Integer(std::int64_t least, std::int64_t most) noexcept ARMCMC_NONBLOCKING {
    std::int64_t value = 0;
    Take(&value, 1);
    Require(value >= least && value <= most);
    return good_ ? value : least;
  }
  /// Next bool; any byte but 0 and 1 is an error.
  [[nodiscard]] bool Flag() noexcept ARMCMC_NONBLOCKING {
    std::uint8_t value = 0;
    Take(&value, 1);
    Require(value <= 1);
    return good_ && value == 1;
  }
  /// Next `count` doubles, all of which must be finite. On error all are set to 0. @rt O(count).
  void Row(double* values, std::size_t count) noexcept ARMCMC_NONBLOCKING {
    Take(values, count);
    for (std::size_t i = 0; i < count; ++i) Require(std::isfinite(values[i]));
    if (!good_) std::memset(values, 0, count * sizeof(double));
  }
  /// Next double, which must be finite.
  [[nodiscard]] double Number() noexcept ARMCMC_NONBLOCKING {
    double value = 0.0;
    Row(&value, 1);
    return value;
  }

  /// Adds a condition of the caller, such as a positive definite covariance: good() stays false if it does not hold.
  void Require(bool condition) noexcept ARMCMC_NONBLOCKING { good_ = good_ && condition; }
  /// Whether everything read so far was valid.
  [[nodiscard]] bool good() const noexcept { return good_; }
  /// Whether everything was read, and nothing was wrong.
  [[nodiscard]] bool finished() const noexcept { return good_ && at_ == in_.size(); }

 private:
  template <class T>
  void Take(T* values, std::size_t count) noexcept ARMCMC_NONBLOCKING {
    const std::size_t bytes = count * sizeof(T);
    Require(bytes <= in_.size() - at_);
    if (!good_) return;
    std::memcpy(values, in_.data() + at_, bytes);
    at_ += bytes;
  }

  std::span<const std::byte> in_;
  std::size_t at_ = 0;
  bool good_ = true;
};

/// Hash of everything in the settings that gives a posterior its meaning: model, parameters, priors, bounds, noise,
/// constants, effects, overlap. A snapshot with another identity must not be restored. Draws, seed and forgetting may
/// differ.
/// @return FNV-1a, 64 bits, of names and bit patterns.
[[nodiscard]] std::uint64_t SnapshotIdentity(const EstimatorSettings& settings) noexcept;

}  // namespace armcmc
