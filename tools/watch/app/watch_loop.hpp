#pragma once

#include <cstdint>
#include <string>

#include "armcmc/watch/sparkline.hpp"

namespace armcmc::watch {

struct WatchOptions {
  std::string url;
  std::string prefix;
  std::int64_t steps = 0;   ///< Stop after so many; 0: never.
  double duration_s = 0.0;  ///< Stop after so long; 0: never.
  bool json = false;
  bool lines = false;
  bool screen = false;  ///< Standard output is a terminal that is ours.
  Glyphs glyphs = Glyphs::kUnicode;
  bool colour = true;
};

/// Watches until the steps or the time are over, or somebody ends it. @return the exit code.
/// @throws what Bus throws.
int Watch(const WatchOptions& options);

}  // namespace armcmc::watch
