#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "armcmc/gap/search.hpp"

namespace armcmc::gap::test {

/// Effects of every hypothesis that a finding holds possible.
[[nodiscard]] inline std::vector<std::vector<std::string>> NamesOf(const Finding& finding) {
  std::vector<std::vector<std::string>> names;
  for (const CandidatePtr& candidate : finding.set) names.push_back(candidate->names());
  return names;
}

/// Whether a finding holds it possible that this effect alone is what is missing.
[[nodiscard]] inline bool SetHolds(const Finding& finding, const std::string& effect) {
  const auto names = NamesOf(finding);
  return std::find(names.begin(), names.end(), std::vector<std::string>{effect}) != names.end();
}

}  // namespace armcmc::gap::test
