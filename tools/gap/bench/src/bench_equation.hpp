#pragma once

#include <string_view>

namespace armcmc::gap_bench {

/// One equation of a plant that has several.
struct BenchEquation {
  std::string_view name;                            ///< As gap::Equation says it.
  bool (*feels)(std::string_view effect) noexcept;  ///< Whether an effect of the plant changes what it predicts.
};

}  // namespace armcmc::gap_bench
