#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "armcmc/types.hpp"

namespace armcmc {

inline constexpr int kMaxEffects = 5;           ///< Added to one model; the sampled coordinates bound them further.
inline constexpr int kMaxEffectAmplitudes = 2;  ///< Parameters of one effect that are estimated online.
inline constexpr int kMaxEffectShapes = 2;      ///< Parameters of one effect that are frozen.
inline constexpr int kEffectMemory = 2;         ///< Numbers that an effect may carry from sample to sample.

/// Where an effect acts. The order of the list is the order of evaluation, the same everywhere.
enum class EffectSlot : std::uint8_t {
  kInputMap,         ///< Changes the inputs of the constitutive law.
  kConstitutiveLaw,  ///< Changes a parameter of the law.
  kAdditive,         ///< Adds amplitude x feature to the force.
  kSensorDelay,      ///< Acts on the series of forces: dead time first,
  kSensorLag,        ///< then the low pass.
  kSensorStatics,    ///< Maps each force after that.
};

inline constexpr int kMaxEffectSizes = 8;  ///< Sizes that one compiled plant may define.
/// The sizes of a plant's signals, SI, that make priors free of units. Their order is the plant's: see effect_sizes.hpp
/// in its folder.
struct EffectScales {
  std::array<double, kMaxEffectSizes> size{1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
};

/// A parameter that is estimated together with those of the base model. Its prior is N(mean, sd^2) cut at the bounds,
/// in multiples of `unit_size`.
struct EffectAmplitude {
  std::string_view name;                                     ///< Within the effect; in messages after its name.
  std::string_view unit;                                     ///< As text.
  double mean, sd, lower, upper;                             ///< lower = 0 where the physics has a sign.
  double (*unit_size)(const EffectScales& scales) noexcept;  ///< In the parameter's unit.
};

/// A parameter that is frozen while the estimator runs.
struct EffectShape {
  std::string_view name;
  std::string_view unit;
  double typical;  ///< Multiple of `unit_size`.
  double (*unit_size)(const EffectScales& scales) noexcept;
  double lower, upper;  ///< Allowed values, in the parameter's unit.
};

/// One physical effect of the catalogue of a compiled plant. What else an effect has is up to the plant: see
/// effects.hpp in its folder.
struct EffectInfo {
  std::string_view name;     ///< "coulomb_friction".
  std::string_view family;   ///< Effects of one family act alike: "dry friction".
  std::string_view formula;  ///< For people to read.
  EffectSlot slot;
  bool online;         ///< The estimator can run it.
  int num_amplitudes;  ///< At most kMaxEffectAmplitudes.
  std::array<EffectAmplitude, kMaxEffectAmplitudes> amplitudes;
  int num_shapes;
  std::array<EffectShape, kMaxEffectShapes> shapes;
};

namespace effect_unit {
/// For a parameter without a scale: its size is absolute.
constexpr double One(const EffectScales&) noexcept { return 1.0; }
}  // namespace effect_unit

}  // namespace armcmc
