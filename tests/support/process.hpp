#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace armcmc::test {

/// A program run by a test. Its output goes to files, which can be read any time. Killed at the end of its life.
class Process {
 public:
  struct Exit {
    int code = -1;   ///< Exit code, when it ended by itself.
    int signal = 0;  ///< Signal that ended it, or 0.
    bool timed_out = false;
  };

  /// Starts it. @param working_directory where it starts; empty: where the test runs. With one, `program` is absolute.
  /// @throws std::runtime_error when it cannot be started.
  Process(const std::filesystem::path& program, const std::vector<std::string>& arguments,
          const std::filesystem::path& working_directory = {});
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void Signal(int signal) const;
  /// Waits for its end; kills it when it takes longer.
  Exit Wait(std::chrono::milliseconds timeout);
  [[nodiscard]] bool running();
  [[nodiscard]] std::string out() const;
  [[nodiscard]] std::string err() const;
  /// Waits until stderr holds a text. @return false after the timeout, or when the process ends without.
  [[nodiscard]] bool WaitForErr(const std::string& text, std::chrono::milliseconds timeout);

 private:
  bool Reap(int options);

  std::filesystem::path dir_;
  pid_t pid_ = -1;
  bool ended_ = false;
  Exit exit_;
};

/// Result of a program run to its end; code -1 when it was not over in its time.
struct Outcome {
  int code = -1;
  std::string out, err;
};
[[nodiscard]] Outcome RunProgram(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                                 std::chrono::milliseconds timeout = std::chrono::minutes(10),
                                 const std::filesystem::path& working_directory = {});

}  // namespace armcmc::test
