// Configurations of the estimator. A bad one is an error with a line, never anything else.
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "armcmc/support/estimator_config.hpp"
#include "armcmc/support/strict_toml.hpp"
#include "rt_config.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace armcmc;
  try {
    auto root = support::StrictTable::FromText({reinterpret_cast<const char*>(data), size}, "fuzzed.toml");
    const EstimatorSettings settings = support::ReadEstimatorSettings(root, "");
    (void)app::ReadRtSettings(root);
    (void)app::ReadGapLogSettings(root);
    root.Finish();
    settings.Validate();  // what was read without an error is valid
  } catch (const support::ConfigError&) {
  }
  return 0;
}
