#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace armcmc::support {

/// The known name that `typed` most likely stands for: least edit distance, letter case ignored, and no more
/// than a third of the letters wrong (two for short names). Empty when none is that near.
[[nodiscard]] std::string Nearest(std::string_view typed, const std::vector<std::string>& known);

/// " (did you mean NAME?)", or nothing.
[[nodiscard]] std::string DidYouMean(std::string_view typed, const std::vector<std::string>& known);

}  // namespace armcmc::support
