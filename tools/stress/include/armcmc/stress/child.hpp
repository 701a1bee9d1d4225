#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace armcmc::stress {

/// A program that runs beside this one and dies with it. Its output goes to one file, which is kept short.
class Child {
 public:
  /// @param log  stdout and stderr. @throws std::runtime_error when it cannot be started.
  Child(const std::vector<std::string>& command, std::filesystem::path log);
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  void Signal(int signal) const;
  [[nodiscard]] bool running();
  /// Waits for its end; kills it when it takes longer.
  void Wait(int timeout_ms);
  /// Exit code; 128 + signal when a signal ended it; -1 while it runs.
  [[nodiscard]] int exit_code() const { return exit_code_; }
  /// Resident memory now, kB; 0 when it has ended.
  [[nodiscard]] long rss_kb() const;
  /// What it wrote last.
  [[nodiscard]] std::string output() const;
  /// Cuts a file that has grown beyond a megabyte: a run of days must not fill the disk.
  void TrimLog() const;

 private:
  bool Reap(int options);

  std::filesystem::path log_;
  pid_t pid_ = -1;
  int exit_code_ = -1;
};

}  // namespace armcmc::stress
