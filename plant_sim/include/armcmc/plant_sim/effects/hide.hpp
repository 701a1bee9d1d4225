#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/plant_sim/scenario.hpp"

namespace armcmc::plant_sim {

/// A requested effect.
struct EffectRequest {
  std::string name, variant;  ///< An empty variant: one of those of the name, drawn.
  Gate gate;
  double gap_ratio = 1.0;  ///< R to reach; no matter when the strength is given.
  std::vector<std::pair<std::string, double>>
      values;  ///< Parameters by name; the others are drawn, the strength found.
};

/// What a run hides, by kind. A pair is of two different names.
enum class HiddenKind : std::uint8_t { kNone, kSingle, kPair, kOutside };
[[nodiscard]] const char* HiddenKindName(HiddenKind kind) noexcept;
/// The kind of a list of at most two effects.
[[nodiscard]] HiddenKind KindOf(const std::vector<HiddenEffect>& effects) noexcept;

/// "NAME[:VARIANT][,NAME[:VARIANT]]" with one gate and ratio for all. @throws std::invalid_argument when malformed.
[[nodiscard]] std::vector<EffectRequest> ParseEffectRequests(const std::string& text, const Gate& gate,
                                                             double gap_ratio);

/// Chooses every parameter of the requested effects. The same scenario, requests and seed give the same effects.
/// @throws std::invalid_argument naming what is unknown, requested twice, or out of range.
[[nodiscard]] std::vector<HiddenEffect> DecideEffects(const Scenario& scenario,
                                                      const std::vector<EffectRequest>& requests, std::uint64_t seed);

/// Nothing, one effect, two, or one outside the catalogue, each drawn as often as the other; then which, its formula,
/// shape and sign. Without a gate, half of them act always and the others by a gate that is drawn, too.
/// Effects that cannot reach the ratio in this scenario are drawn again.
[[nodiscard]] std::vector<HiddenEffect> DrawEffects(const Scenario& scenario, double gap_ratio,
                                                    const std::optional<Gate>& gate, std::uint64_t seed);

}  // namespace armcmc::plant_sim
