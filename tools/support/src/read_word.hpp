#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "armcmc/support/strict_toml.hpp"

namespace armcmc::support {

inline constexpr double kMax = std::numeric_limits<double>::infinity();
/// Positive, and far enough from zero that its square and its inverse are finite.
inline constexpr double kTiny = 1e-100;

template <typename Enum>
using Words = std::vector<std::pair<std::string, Enum>>;

/// The value whose word the key holds; the message of an error lists the words.
template <typename Enum>
Enum ReadWord(StrictTable& table, std::string_view key, Enum fallback, const Words<Enum>& words) {
  std::vector<std::string> names;
  std::string fallback_name;
  for (const auto& [name, value] : words) {
    names.push_back(name);
    if (value == fallback) fallback_name = name;
  }
  const std::string chosen = table.Choice(key, fallback_name, names);
  for (const auto& [name, value] : words)
    if (name == chosen) return value;
  return fallback;
}

}  // namespace armcmc::support
