#include "armcmc/support/program.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <new>
#include <optional>

#include "armcmc/support/printable.hpp"
#include "armcmc/support/strict_toml.hpp"

namespace armcmc::support {
namespace {

int PrintError(const std::string& name, const std::string& what, int code) {
  std::cerr << name << ": " << ErrorLine(what) << '\n';
  return code;
}

}  // namespace

std::string Version() { return ARMCMC_VERSION; }

int RunProgram(CLI::App& app, const std::string& name, int argc, char** argv, const std::function<int()>& body,
               Output output) {
  app.name(name);
  app.set_version_flag("--version", name + " " + Version(), "Print the version and exit");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& wanted) {  // --help, --version
    return app.exit(wanted);
  } catch (const CLI::Error& error) {
    return PrintError(name, std::string(error.what()) + " (see " + name + " --help)", kExitBadInput);
  }
  try {
    std::optional<EscapedOutput> escaped;
    if (output == Output::kText) escaped.emplace();
    const int code = body();
    // A full disk or a closed pipe shows only now.
    if (!std::cout.flush()) return PrintError(name, "cannot write to standard output", kExitFailure);
    return code;
  } catch (const ConfigError& error) {
    return PrintError(name, error.what(), kExitBadInput);
  } catch (const InputError& error) {
    return PrintError(name, error.what(), kExitBadInput);
  } catch (const std::invalid_argument& error) {
    return PrintError(name, error.what(), kExitBadInput);
  } catch (const std::bad_alloc&) {
    return PrintError(name, "out of memory", kExitFailure);
  } catch (const std::exception& error) {
    return PrintError(name, error.what(), kExitFailure);
  }
}

}  // namespace armcmc::support
