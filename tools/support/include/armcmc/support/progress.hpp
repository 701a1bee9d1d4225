#pragma once

#include <chrono>
#include <string>

namespace armcmc::support {

/// A progress bar on stderr, when that is a terminal; otherwise silent but for notes. Redrawn at most ten times a
/// second and wiped at the end.
class Progress {
 public:
  explicit Progress(const std::string& title);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// @param share  Of the work done, in [0, 1].
  void Update(double share);
  /// A line of its own on stderr, terminal or not: the end of a part of a work that takes hours.
  void Note(const std::string& line);
  /// The line that is drawn for a share: title, bar, percent and remaining time when it is known (>= 0 s).
  [[nodiscard]] static std::string Line(const std::string& title, double share, double remaining_s, int width);

 private:
  void Wipe();

  std::string title_;
  bool on_terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_drawn_;
};

}  // namespace armcmc::support
