#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace armcmc::model {

/// The command line: one of the subcommands check, list, new, add.
struct Arguments {
  std::string plant;                         ///< check, add
  std::vector<std::string> with;             ///< check
  bool effects = false;                      ///< check
  std::string data;                          ///< check, add
  std::string data_dir;                      ///< check
  bool skip_bad = false;                     ///< check
  std::string effect, out;                   ///< add
  std::string name, from = ARMCMC_NEW_FROM;  ///< new
};

void Declare(CLI::App* app, Arguments* arguments);

}  // namespace armcmc::model
