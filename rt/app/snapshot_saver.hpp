#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "armcmc/rt/snapshot_hand_over.hpp"
#include "snapshot_file.hpp"

namespace armcmc::app {

/// Writes what the estimator has learnt to a file, on a thread of its own without real-time priority: once per second
/// while the posterior changes, and when it is stopped. A write that fails is counted, and reported once until one
/// works again, and tried again a second later; the estimator does not notice.
class SnapshotSaver {
 public:
  using Say = std::function<void(const std::string&)>;
  using OnFailure = std::function<void()>;

  /// @param start  What is in the file already, so that a part of which nothing new comes is kept.
  SnapshotSaver(std::string path, Snapshot start, rt::SnapshotHandOver* parts, Say say, OnFailure on_failure);
  ~SnapshotSaver() { Stop(); }
  SnapshotSaver(const SnapshotSaver&) = delete;
  SnapshotSaver& operator=(const SnapshotSaver&) = delete;

  void Start();
  /// Writes what is still due. After the stages have ended, so that it is the last state.
  void Stop();
  /// Takes what is new and writes it. Without Start() only.
  void Save();

  [[nodiscard]] std::int64_t written() const noexcept { return written_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::int64_t failed() const noexcept { return failed_.load(std::memory_order_relaxed); }
  /// Pack of the snapshot at the start; 0: there was none.
  [[nodiscard]] std::int64_t resumed_from() const noexcept { return resumed_from_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  void Take();
  [[nodiscard]] bool Complete() const;

  std::string path_;
  Snapshot snapshot_;
  std::vector<std::vector<std::byte>> adjusted_, executed_;  // by recursion
  std::int64_t resumed_from_;
  rt::SnapshotHandOver* parts_;
  Say say_;
  OnFailure on_failure_;
  bool fresh_ = false;  // something was taken that is not in the file
  bool reported_ = false;
  std::atomic<std::int64_t> written_{0}, failed_{0};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// Reads the snapshot of an estimator at its start. One line says what comes of it. A snapshot that is refused is
/// renamed to PATH.refused, or PATH.refused2 and so on where there is one: the next snapshot does not replace it.
/// @param use  Takes the content over; false: it is damaged all the same.
/// @return what was read; without parts when there is nothing to go on from.
/// @throws support::InputError when the file is something else (MayBeSnapshot()), is no regular file, or may not be
///         read: it stays as it is, and so nothing can be saved under this name.
[[nodiscard]] Snapshot LoadSnapshot(const std::string& path, std::uint64_t identity, std::int64_t now_utime,
                                    const std::function<bool(const Snapshot&)>& use, const SnapshotSaver::Say& say);

}  // namespace armcmc::app
