#pragma once

#include <array>
#include <cstdint>

#include "armcmc/gap/signals.hpp"

namespace armcmc::gap {

/// What an expression of a form may read at every sample, besides dt, coordinates and states. The order is that of
/// kFormSignals.
enum class FormSignal : std::uint8_t {
  kPosition,
  kVelocity,
  kAcceleration,
  kPressure,
  kOpening,
  kActive,      ///< 1 where the law acts.
  kRetreating,  ///< Probability that the true velocity is negative, given the smoothed one.
  kLaw,         ///< The series that a filter is given.
  kDrive,       ///< Of a simulated motion: acceleration by the input,
  kBase,        ///< and acceleration of the law without effects.
  kTime,        ///< s
  kCount,
};
inline constexpr int kNumFormSignals = static_cast<int>(FormSignal::kCount);
static_assert(static_cast<int>(FormSignal::kOpening) == static_cast<int>(Role::kOpening));
inline constexpr std::array<const char*, static_cast<std::size_t>(kNumFormSignals)> kFormSignals{
    "x", "v", "a", "p", "u", "active", "retreating", "law", "drive", "base", "t"};

inline constexpr int kMostFormCoordinates = 12;
inline constexpr int kMostFormStates = 8;
inline constexpr int kMostPasts = 4;

// Indices of a form's symbols. A program has them all as inputs, so that no two kinds of symbol share an index.
inline constexpr int kFirstState = kNumFormSignals;
inline constexpr int kFirstPast = kFirstState + kMostFormStates;  ///< What a function with memory comes to.
inline constexpr int kFirstValue = kFirstPast + kMostPasts;       ///< Of coordinates and, after them, the origin.
inline constexpr int kNumFormInputs = kFirstValue + kMostFormCoordinates + 1;

/// A state of a form, as nodes of a graph.
struct FormState {
  int start = -1;  ///< Before the first sample; read there.
  int rate = -1;   ///< Its derivative; -1: `next` is given,
  int next = -1;   ///< the value one sample later.
};

}  // namespace armcmc::gap
