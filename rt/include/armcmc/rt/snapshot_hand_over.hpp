#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/latest_value.hpp"

namespace armcmc::rt {

/// State that one stage carries from pack to pack, as bytes for the thread that writes them to the disk.
struct SnapshotPart {
  std::int64_t seq = 0;          ///< Pack after which it was taken.
  std::size_t size = 0;          ///< Used bytes.
  std::vector<std::byte> bytes;  ///< Size is fixed after construction.
  /// The used bytes, as SnapshotReader takes them.
  [[nodiscard]] std::span<const std::byte> used() const noexcept { return {bytes.data(), size}; }
};

/// Newest snapshot of one stage. The stage writes it after every step; another thread takes the newest complete one.
/// Triple buffer (LatestValue): neither side waits, and a snapshot that is not taken in time is replaced.
class SnapshotChannel {
 public:
  /// @param bytes  Size of a snapshot, Estimator::kSnapshotBytes. Allocates three buffers.
  explicit SnapshotChannel(std::size_t bytes) {
    for (SnapshotPart& part : parts_) part.bytes.resize(bytes);
  }

  /// Stage only.
  /// @param seq   Of the pack after which it is taken.
  /// @param save  Writes into the span and returns the bytes used, 0 when they do not fit. In that case nothing is
  ///   handed over, and the previous snapshot stays the newest.
  /// @rt Wait-free, when `save` is.
  template <class Save>
  void Write(std::int64_t seq, const Save& save) noexcept ARMCMC_NONBLOCKING {
    SnapshotPart& part = parts_[static_cast<std::size_t>(latest_.write_slot())];
    part.size = save(std::span<std::byte>(part.bytes));
    part.seq = seq;
    if (part.size > 0) (void)latest_.Publish();
  }

  /// The other thread only. @return the newest part, or nullptr when it has been read; valid until the next call.
  [[nodiscard]] const SnapshotPart* Take() noexcept {
    return latest_.Acquire() ? &parts_[static_cast<std::size_t>(latest_.read_slot())] : nullptr;
  }

 private:
  /// Which of the three buffers belongs to whom.
  LatestValue latest_;
  std::array<SnapshotPart, LatestValue::kSlots> parts_;
};

/// Channels of the two stages that carry state, adjust (posterior) and execute (gap watch), for each recursion where
/// packs overlap: a pack changes what one of them knows. The newest parts of a recursion may be one step apart.
///
/// Threads: the adjust thread writes `adjusted`, the execute thread `executed`, and one thread without a deadline takes
/// both and writes them to the disk. All buffers are allocated at construction.
class SnapshotHandOver {
 public:
  /// What one recursion of the estimator hands over.
  struct Recursion {
    /// @param bytes  Size of each of the two snapshots.
    explicit Recursion(std::size_t bytes) : adjusted(bytes), executed(bytes) {}
    SnapshotChannel adjusted, executed;  ///< From Estimator::SaveAdjusted() and SaveExecuted().
  };
  /// @param bytes       Size of each snapshot.
  /// @param recursions  At least 1.
  explicit SnapshotHandOver(std::size_t bytes, int recursions = 1) {
    for (int j = 0; j < recursions; ++j) recursions_.emplace_back(bytes);
  }

  /// Number of recursions. @rt O(1).
  [[nodiscard]] int size() const noexcept ARMCMC_NONBLOCKING { return static_cast<int>(recursions_.size()); }
  /// Channels of recursion j. @pre 0 <= j < size(). @rt O(1).
  [[nodiscard]] Recursion& of(int j) noexcept ARMCMC_NONBLOCKING { return recursions_[static_cast<std::size_t>(j)]; }

 private:
  std::deque<Recursion> recursions_;  // which do not move
};

/// The parts of all recursions in a row: a single one as it is, several with the size of each before it (u32, byte
/// order of the machine). Allocates; for the thread that writes the file.
/// @pre at least one part.
[[nodiscard]] std::vector<std::byte> JoinParts(std::span<const std::vector<std::byte>> parts);
/// Undoes JoinParts(). The contents of the parts are not checked; Estimator::Restore() does that.
/// @param bytes  As JoinParts() returned them.
/// @param count  Number of recursions, at least 1.
/// @return `count` parts, or none if a size does not fit the bytes or bytes are left over.
[[nodiscard]] std::vector<std::vector<std::byte>> SplitParts(std::span<const std::byte> bytes, int count);

}  // namespace armcmc::rt
