#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace armcmc::replay {

/// The command line.
struct Arguments {
  std::string config, data, recording, data_dir, out, model, draws_from, predictions, report, prefix;
  std::string compare, compare_model;  ///< A second configuration or model to compare with.
  std::string calibrate;               ///< Configuration to write.
  double false_modifications = 1e-3;   ///< Share of packs that may be taken for a change.
  std::optional<std::uint64_t> seed;
  bool skip_bad = false, verify = false;
  [[nodiscard]] bool compares() const { return !compare.empty() || !compare_model.empty(); }
};

void Declare(CLI::App* app, Arguments* arguments);

/// Finds what was left out, and refuses what does not go together.
/// @throws support::InputError naming the option.
void Complete(Arguments* arguments);

}  // namespace armcmc::replay
