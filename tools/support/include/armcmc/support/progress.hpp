#pragma once

#include <chrono>
#include <string>

namespace armcmc::support {

/// A progress bar on stderr, when that is a terminal; otherwise silent. Redrawn at most ten times a second and
/// wiped at the end.
class Progress {
 public:
  explicit Progress(std::string title);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// @param share  Of the work done, in [0, 1].
  void Update(double share);
  /// The line that is drawn for a share: title, bar, percent and remaining time when it is known (>= 0 s).
  [[nodiscard]] static std::string Line(const std::string& title, double share, double remaining_s, int width);

 private:
  std::string title_;
  bool on_terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_drawn_;
};

}  // namespace armcmc::support
