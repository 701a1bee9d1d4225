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

/// Runs a program: parses the command line (--help and --version included), then calls body.
///
/// ConfigError, InputError, CLI errors and std::invalid_argument become one line on stderr,
/// "NAME: what", and kExitBadInput; any other exception one line and kExitFailure.
/// @param app   Options are added by the caller; --version and the program's name are added here.
/// @param body  Its value is the exit code.
int RunProgram(CLI::App& app, const std::string& name, int argc, char** argv, const std::function<int()>& body);

}  // namespace armcmc::support
