#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <type_traits>
#include <utility>

#include "armcmc/effects/effect.hpp"

namespace armcmc {

/// The effects of a compiled plant as a list of types.
template <class... Effects>
struct EffectList {
  static constexpr int kSize = sizeof...(Effects);
  static constexpr std::array<const EffectInfo*, sizeof...(Effects)> kInfos{&Effects::kInfo...};

  /// Index of the effect with that name, -1 if there is none.
  [[nodiscard]] static constexpr int Find(std::string_view name) noexcept {
    for (int i = 0; i < kSize; ++i)
      if (kInfos[static_cast<std::size_t>(i)]->name == name) return i;
    return -1;
  }
  /// Index of an effect; it must be in the list.
  template <class E>
  static constexpr std::size_t kIndexOf = static_cast<std::size_t>(Find(E::kInfo.name));

  /// Calls each(std::type_identity<E>, index) for every effect, in order.
  template <class Function>
  static constexpr void ForEach(Function&& each) {
    [&]<std::size_t... I>(std::index_sequence<I...>) { (each(std::type_identity<Effects>(), I), ...); }
    (std::make_index_sequence<sizeof...(Effects)>());
  }
};

}  // namespace armcmc
