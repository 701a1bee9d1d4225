#pragma once

#include <cstdint>
#include <string>

#include "armcmc/plant_sim/plant.hpp"

namespace armcmc::plant_sim {

/// When an effect acts. While it does not, it leaves every signal bit-identical; its memory keeps running.
struct Gate {
  enum class Kind : std::uint8_t { kAlways, kContact, kFree, kFrom, kUntil };

  Kind kind = Kind::kAlways;
  double at_s = 0.0;  ///< Plant time of kFrom (t >= at_s) and kUntil (t < at_s).

  /// "always", "contact", "free", "from:S" or "until:S". @throws std::invalid_argument for any other text.
  static Gate Parse(const std::string& text);
  /// What Parse reads.
  [[nodiscard]] std::string Text() const;
  /// @param truth a sample of the plant; mode 0 is contact. @rt No heap, no lock, no throw.
  [[nodiscard]] bool Open(const PlantSample& truth) const noexcept;
};

}  // namespace armcmc::plant_sim
