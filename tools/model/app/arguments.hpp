#pragma once

#include <string>

namespace CLI {
class App;
}

namespace armcmc::model {

/// The command line: one of the subcommands check, list, new.
struct Arguments {
  std::string plant;                      ///< check
  std::string name, from = "servo_axis";  ///< new
};

void Declare(CLI::App* app, Arguments* arguments);

}  // namespace armcmc::model
