#pragma once

#include <string>

#include "armcmc/gap/result.hpp"

namespace armcmc::gap {

/// The result for a terminal: the sentence, the added effects with their parameters, what the data determine in place
/// of parameters that are confounded, the held-out error, the proposed experiment, and the notes. Lines, each with its
/// end.
[[nodiscard]] std::string Summary(const Result& result);

/// The ladder, rung by rung, as a table; then the error of each held-out segment, if there are several.
[[nodiscard]] std::string LadderText(const Result& result);

}  // namespace armcmc::gap
