#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace armcmc::support {

/// Path of another program of the product ("armcmc-plant"): in the folder of the running one.
[[nodiscard]] std::filesystem::path SiblingProgram(const std::string& name);

/// How a process ended.
struct SubprocessEnd {
  int code = 0;        ///< Exit code, or minus the signal that ended it.
  std::string errors;  ///< What it wrote to stderr.
};

/// Runs a program and waits for its end. It reads nothing, and what it prints is lost; threads may call this at once.
/// @param folder  Where it runs.
/// @throws std::runtime_error naming the program when it cannot be started.
[[nodiscard]] SubprocessEnd RunSubprocess(const std::filesystem::path& program,
                                          const std::vector<std::string>& arguments,
                                          const std::filesystem::path& folder);

}  // namespace armcmc::support
