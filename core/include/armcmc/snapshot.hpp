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
///
/// Not thread-safe: one writer fills one span, within one call of Estimator::SaveAdjusted() or
/// SaveExecuted().
class SnapshotWriter {
 public:
  /// @param out  Memory to fill; must outlive the writer.
  explicit SnapshotWriter(std::span<std::byte> out) noexcept : out_(out) {}

  /// Appends an arithmetic value in its own unit; sizeof(T) bytes.
  /// @rt No heap, no lock, no throw. O(1).
  /// @tparam T  double, or an integer of fixed width; not bool.
  template <class T>
  void Put(const T& value) noexcept ARMCMC_NONBLOCKING {
    PutRow(&value, 1);
  }
  /// Appends a bool as one byte, 0 or 1; SnapshotReader::Flag() is its counterpart.
  /// @rt No heap, no lock, no throw. O(1).
  void PutFlag(bool flag) noexcept ARMCMC_NONBLOCKING { Put(static_cast<std::uint8_t>(flag ? 1 : 0)); }

  /// Appends `count` arithmetic values (not bool), as they are in memory: count sizeof(T) bytes, without padding and
  /// without the count itself, which the reader has to know.
  /// @param values  Contiguous. @param count  Number of values; may be 0.
  /// @rt No heap, no lock, no throw. O(count).
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

  /// Bytes written, or 0 when the memory was too small for all. Check it once, after the last Put.
  [[nodiscard]] std::size_t size() const noexcept { return fits_ ? size_ : 0; }

 private:
  /// Values that no longer fit are skipped, so the first `size_` bytes are always whole values.
  std::span<std::byte> out_;
  std::size_t size_ = 0;
  bool fits_ = true;
};

/// Reads what a SnapshotWriter wrote, without trusting it: after the first value that is missing, not finite or out of
/// its range, good() is false from then on, and every value reads as the lowest one allowed, or zero. So a reader can
/// read everything first, and check once.
///
/// The calls must match those of the writer in order, type and count; there are no tags between the values.
/// @code
/// SnapshotReader in(bytes);
/// const int rows = static_cast<int>(in.Integer(0, kMaxRows));
/// in.Row(values.data(), static_cast<std::size_t>(rows));
/// if (!in.finished()) return false;  // damaged, cut or too long: nothing is restored
/// @endcode
class SnapshotReader {
 public:
  /// @param in  Bytes of a snapshot; must outlive the reader.
  explicit SnapshotReader(std::span<const std::byte> in) noexcept : in_(in) {}

  /// Next 64-bit integer.
  /// @param least, most  Allowed range, both ends included.
  /// @return `least` if the value is outside it or missing.
  /// @rt No heap, no lock, no throw. O(1).
  [[nodiscard]] std::int64_t Integer(std::int64_t least, std::int64_t most) noexcept ARMCMC_NONBLOCKING {
    std::int64_t value = 0;
    Take(&value, 1);
    Require(value >= least && value <= most);
    return good_ ? value : least;
  }
  /// Next byte. @param most  Largest allowed. @return 0 if it is larger or missing. @rt As Integer().
  [[nodiscard]] std::uint8_t Byte(std::uint8_t most) noexcept ARMCMC_NONBLOCKING {
    std::uint8_t value = 0;
    Take(&value, 1);
    Require(value <= most);
    return good_ ? value : std::uint8_t{0};
  }
  /// Next bool; any byte but 0 and 1 is an error. @return false on error. @rt As Integer().
  [[nodiscard]] bool Flag() noexcept ARMCMC_NONBLOCKING { return Byte(1) == 1; }
  /// Next `count` doubles, all of which must be finite. On error all are set to 0.
  /// @param values  Receives them.
  /// @param count   Number of doubles, as it was written.
  /// @rt No heap, no lock, no throw. O(count).
  void Row(double* values, std::size_t count) noexcept ARMCMC_NONBLOCKING {
    Take(values, count);
    for (std::size_t i = 0; i < count; ++i) Require(std::isfinite(values[i]));
    if (!good_) std::memset(values, 0, count * sizeof(double));
  }
  /// Next double, which must be finite. @return 0 on error. @rt As Integer().
  [[nodiscard]] double Number() noexcept ARMCMC_NONBLOCKING {
    double value = 0.0;
    Row(&value, 1);
    return value;
  }

  /// Adds a condition of the caller, such as a positive definite covariance: good() stays false if it does not hold.
  /// @rt No heap, no lock, no throw. O(1).
  void Require(bool condition) noexcept ARMCMC_NONBLOCKING { good_ = good_ && condition; }
  /// Whether everything read so far was valid. @rt This and the following: no heap, no lock, no throw. O(1).
  [[nodiscard]] bool good() const noexcept { return good_; }
  /// Whether everything was read, and nothing was wrong.
  [[nodiscard]] bool finished() const noexcept { return good_ && at_ == in_.size(); }

 private:
  /// Copies the next `count` values, or sets good_ to false if fewer bytes are left.
  template <class T>
  void Take(T* values, std::size_t count) noexcept ARMCMC_NONBLOCKING {
    const std::size_t bytes = count * sizeof(T);
    Require(bytes <= in_.size() - at_);
    if (!good_) return;
    std::memcpy(values, in_.data() + at_, bytes);
    at_ += bytes;
  }

  /// The first `at_` bytes have been read.
  std::span<const std::byte> in_;
  std::size_t at_ = 0;
  bool good_ = true;
};

/// Hash of everything in the settings that gives a posterior its meaning: model, parameters, priors, bounds, noise,
/// constants, effects, overlap. A snapshot with another identity must not be restored. Draws, seed and forgetting may
/// differ.
/// @param settings  Valid ones; see EstimatorSettings.
/// @return FNV-1a, 64 bits, of the version of the layout, names and bit patterns. Source: G. Fowler, L. C. Noll and
///   K.-P. Vo, 1991.
[[nodiscard]] std::uint64_t SnapshotIdentity(const EstimatorSettings& settings) noexcept;

}  // namespace armcmc
