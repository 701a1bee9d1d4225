#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace armcmc::app {

/// What an estimator has learnt, as it stands on the disk:
///
///   "ARMCMCSN"  8 bytes
///   version     u32, kOldestSnapshotVersion .. kSnapshotVersion
///   identity    u64, armcmc::SnapshotIdentity() of the settings
///   seq         i64, pack after which the posterior was saved
///   utime       i64, us, CLOCK_REALTIME when it was saved
///   sizes       2 x u32: bytes of the two parts that follow (Estimator::SaveAdjusted and SaveExecuted;
///               of several recursions rt::JoinParts)
///   parts
///   checksum    u64, CRC-64 (ECMA-182) of everything before
///
/// in the byte order of the machine.
struct Snapshot {
  std::uint64_t identity = 0;
  std::int64_t seq = 0;
  std::int64_t utime = 0;
  std::vector<std::byte> adjusted, executed;
};

inline constexpr std::uint32_t kSnapshotVersion = 5;
/// Also read. Of a snapshot of version 3 or 4 the drift of the parameters is left out, and estimated anew.
inline constexpr std::uint32_t kOldestSnapshotVersion = 3;

[[nodiscard]] std::vector<std::byte> EncodeSnapshot(const Snapshot& snapshot);

/// Reads what EncodeSnapshot() wrote.
/// @return empty when it can be used, else why not, in words that end a sentence: "is truncated".
[[nodiscard]] std::string DecodeSnapshot(std::span<const std::byte> bytes, std::uint64_t identity, Snapshot* snapshot);

/// Whether a file that DecodeSnapshot() refuses may have been a snapshot, and not another file that was named by
/// mistake: half of its first 8 bytes are those of a snapshot, or all of them are zero, as in a block that the disk
/// lost, or they are damaged and the version after them is one that there has been.
[[nodiscard]] bool MayBeSnapshot(std::span<const std::byte> bytes);

/// Replaces a file as a whole: whoever reads it, also after a power failure, finds the old content or the new one.
/// @return empty, or why it failed.
[[nodiscard]] std::string ReplaceFile(const std::string& path, std::span<const std::byte> bytes);

/// Reads a file of at most 160 MB. @return empty, or why it failed.
[[nodiscard]] std::string ReadFile(const std::string& path, std::vector<std::byte>* bytes);

}  // namespace armcmc::app
