#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace armcmc::plant_sim {

/// A program run as a process, its two outputs gathered in files of its own.
class Process {
 public:
  /// @param working_directory where it starts. @throws std::runtime_error when it cannot be started.
  Process(const std::string& program, const std::vector<std::string>& arguments, const std::string& working_directory);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void Signal(int signal) const;
  /// Waits for its end. @return the exit code, or minus the signal that ended it.
  int Wait();
  [[nodiscard]] bool Running();
  [[nodiscard]] std::string Out() const;
  [[nodiscard]] std::string Err() const;

 private:
  std::string out_path_, err_path_;
  pid_t pid_ = -1;
  int status_ = 0;
  bool ended_ = false;
};

}  // namespace armcmc::plant_sim
