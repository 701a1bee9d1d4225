#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "armcmc/data_pack.hpp"
#include "armcmc/rt/hand_over.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::app {

/// Where the data around a suspected gap go.
struct GapLogSettings {
  std::string directory = "gap_logs";  ///< Made when the first file is written; empty: nothing is written.
  double window_s = 60.0;              ///< Data before the alarm.
  double after_s = 20.0;               ///< Data after it.
  int max_files = 10;                  ///< Oldest of our files in the directory are removed beyond that.
  int overlap = 1;                     ///< EstimatorSettings::overlap: samples that packs share are kept once.
};

/// What a recording calls the inputs and, last, the output of the plant that is estimated.
[[nodiscard]] std::vector<std::string> ColumnsOf(const EstimatorSettings& settings);

/// Keeps the last packs and, when the gap watch raises its alarm, writes them to a CSV that armcmc-gap and
/// armcmc-replay read, its columns named as those of the plant (ColumnsOf). Once at the alarm, and again under the same
/// name when the data after it are complete or the run ends. A file appears whole (written beside its name, flushed to
/// the disk, renamed) or not at all.
///
/// Runs on a thread of its own without real-time priority. Memory is fixed: at most kMaxRows samples are kept, so that
/// at high sample rates the window is shorter than asked for.
class GapLog {
 public:
  static constexpr std::size_t kMaxRows = 200'000;
  using Say = std::function<void(const std::string&)>;

  /// @param columns Names of the inputs, in the order of a pack, then of the output.
  /// @param packs   Filled by the collect stage; emptied here.
  /// @param alarm   Number of the pack at which the alarm rose, 0 while there is none.
  /// @param say     Receives a line about what was written or went wrong; called from the thread of Poll().
  GapLog(const GapLogSettings& settings, std::vector<std::string> columns, rt::RecordRing* packs,
         const std::atomic<std::int64_t>* alarm, Say say);
  ~GapLog() { Stop(); }
  GapLog(const GapLog&) = delete;
  GapLog& operator=(const GapLog&) = delete;

  /// Polls on a thread of its own until Stop(), which writes what is still due.
  void Start();
  void Stop();
  /// Takes new packs and writes what has become due. Without Start() only.
  void Poll();

  /// The file of the alarm; empty: none was written. @pre stopped, or never started.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] std::size_t rows() const noexcept { return rows_written_; }

 private:
  void Take(const DataPack& pack);
  void Trim();
  [[nodiscard]] double* Row(std::size_t i) { return &rows_[((first_ + i) % kMaxRows) * num_columns_]; }
  void Write();
  [[nodiscard]] std::string NewPath() const;
  void RemoveOldest() const;

  GapLogSettings settings_;
  std::vector<std::string> columns_;
  rt::RecordRing* packs_;
  const std::atomic<std::int64_t>* alarm_;
  Say say_;
  std::size_t num_columns_;
  std::vector<double> rows_;  ///< Ring of rows, time first.
  std::size_t first_ = 0, count_ = 0;
  std::int64_t run_id_ = 0;
  bool raised_ = false, complete_ = false;
  double alarm_t_ = 0.0;
  std::string path_;
  std::size_t rows_written_ = 0;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace armcmc::app
