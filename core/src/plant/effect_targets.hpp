#pragma once

#include <string>
#include <string_view>

#include "armcmc/plant/effect.hpp"

namespace armcmc {

/// What modes explain instead of the output, where an effect replaces something in it (see EffectTerm). The law of such
/// a mode gets three lets: the target T as signals have it, T' as effects leave it, and S = T / T' at one place.

/// Targets that depend on the symbol stay as they are read, and the law explains T with T - (T' - law) S; S is 1 until
/// SetTargetSizes.
/// @param prefix  Of the names that are added.
void SplitTargets(const std::string& prefix, const std::string& symbol, PlantDescription* plant);

/// S of every target that has been split: T / T' with a number for each signal, and states where they start; 1 where
/// they depend on time. Adds constants for the numbers.
void SetTargetSizes(const DataScales& scales, PlantDescription* plant);

/// Whether a let is T of some mode, which no effect may change.
[[nodiscard]] bool IsTargetAsRead(std::string_view let);

/// Whether a constant is a number that SetTargetSizes added, which no effect may be bound to.
[[nodiscard]] bool IsTargetReference(std::string_view constant);

}  // namespace armcmc
