#pragma once

#include <string>
#include <string_view>

namespace armcmc::gap {

/// Name of an effect as words in the middle of a sentence: "sensor_lag" -> "sensor lag", "coulomb_friction" ->
/// "Coulomb friction". Plain text.
[[nodiscard]] std::string EffectInSentence(std::string_view name);

}  // namespace armcmc::gap
