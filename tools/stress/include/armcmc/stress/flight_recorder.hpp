#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <string>

#include "armcmc/estimator_status_t.hpp"

namespace armcmc::stress {

/// The estimator's newest statuses, a line each, written to a file when something went wrong: what came before a miss
/// of its own, or all of a fault that was not detected, or from which the estimator did not recover. Memory and file
/// are bounded.
class FlightRecorder {
 public:
  static constexpr std::size_t kStatuses = 400;  ///< The longest slot at 100 Hz, twice.
  static constexpr int kMostReports = 200;

  explicit FlightRecorder(std::filesystem::path file) : file_(std::move(file)) {}

  void Add(const estimator_status_t& status);
  /// Appends the newest `most` statuses under a heading. @throws std::runtime_error when the file cannot be written.
  void Write(const std::string& heading, std::size_t most = kStatuses);

  [[nodiscard]] int reports() const { return reports_; }

 private:
  std::filesystem::path file_;
  std::deque<std::string> lines_;
  estimator_status_t last_{};
  int reports_ = 0;
};

}  // namespace armcmc::stress
