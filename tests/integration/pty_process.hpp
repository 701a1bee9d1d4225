#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace armcmc::test {

/// A program on a terminal of its own, as a user at a keyboard has it. Killed at the end of its life.
class PtyProcess {
 public:
  /// @throws std::runtime_error when it cannot be started.
  PtyProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments, int columns, int rows);
  ~PtyProcess();
  PtyProcess(const PtyProcess&) = delete;
  PtyProcess& operator=(const PtyProcess&) = delete;

  void Type(const std::string& keys) const;
  void Resize(int columns, int rows) const;
  void Signal(int signal) const;
  /// Reads until the output since the last call holds the text. @return false after 20 s.
  [[nodiscard]] bool WaitFor(const std::string& text);
  /// Waits for its end. @return its exit code, -1 when a signal ended it or it took longer than 10 s.
  [[nodiscard]] int Wait();
  /// Keys are echoed and come line by line, as a shell wants it.
  [[nodiscard]] bool TerminalIsAsBefore() const;
  /// Everything it wrote.
  [[nodiscard]] const std::string& output() const { return output_; }

 private:
  /// @return false when the other end is closed.
  bool ReadFor(std::chrono::milliseconds time);

  pid_t pid_ = -1;
  int master_ = -1;
  int slave_ = -1;  // kept open, so that the terminal outlives the program
  std::string output_;
  std::size_t searched_ = 0;
};

}  // namespace armcmc::test
