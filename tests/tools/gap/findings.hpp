#pragma once

#include <string>

#include "armcmc/gap/search.hpp"

namespace armcmc::gap::test {

/// Whether a finding holds it possible that this effect alone is what is missing.
[[nodiscard]] inline bool SetHolds(const Finding& finding, const std::string& effect) {
  return NamesOf(finding).contains({effect});
}

}  // namespace armcmc::gap::test
