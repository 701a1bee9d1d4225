#pragma once

#include <functional>
#include <stdexcept>
#include <string>

namespace CLI {
class App;
}

namespace armcmc::support {

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailure = 1;   ///< Something went wrong that the user did not ask for.
inline constexpr int kExitBadInput = 2;  ///< Bad usage, configuration or data.

/// Bad input data: file, line or key, and what was expected. The program ends with kExitBadInput.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Version of the product, "0.1.0".
[[nodiscard]] std::string Version();

/// What a program writes to standard output and standard error through the C++ streams.
enum class Output {
  kText,     ///< Text, in which control characters are escaped (EscapedOutput): names of a file, paths.
  kColours,  ///< Also escape sequences of its own; the program escapes what it repeats.
};

/// Runs a program: parses the command line (--help and --version included), then calls body.
///
/// ConfigError, InputError, CLI errors and std::invalid_argument become one line on stderr,
/// "NAME: what" as ErrorLine() makes it, and kExitBadInput; any other exception one line and kExitFailure.
/// @param app     Options are added by the caller; --version and the program's name are added here.
/// @param body    Its value is the exit code.
/// @param output  What it may print.
int RunProgram(CLI::App& app, const std::string& name, int argc, char** argv, const std::function<int()>& body,
               Output output = Output::kText);

}  // namespace armcmc::support
