#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/plant_sim/plant.hpp"

namespace armcmc::plant_sim {

/// What effects change on the way from the plant to its sensors, at one sample.
struct EffectSignal {
  PlantSample truth;          ///< What the plant does; no effect changes it.
  double acceleration = 0.0;  ///< Rate of inputs[1] (m/s^2 where that is a velocity), second-order backward difference.
  PlantSample law;            ///< Inputs that the constitutive law is fed.
  Theta theta{};              ///< Parameters that it is fed.
  PlantSample seen;           ///< What reaches the sensors, before their noise.
};

/// An effect that the base equations lack.
class Effect {
 public:
  virtual ~Effect() = default;
  /// One sample. Called at every sample, in order, whether the gate is open or not. @rt No heap, no lock, no throw.
  virtual void Apply(EffectSignal* signal) noexcept = 0;
};

/// An effect inside the equations of a plant, which knows what it is: see Plant::Hide.
class InnerEffect {
 public:
  virtual ~InnerEffect() = default;
};

/// An effect from a function object; what it captures is the effect's parameters and memory.
template <typename Function>
[[nodiscard]] std::unique_ptr<Effect> MakeEffect(Function function) {
  class Of final : public Effect {
   public:
    explicit Of(Function f) : f_(std::move(f)) {}
    void Apply(EffectSignal* signal) noexcept override { f_(signal); }

   private:
    Function f_;
  };
  return std::make_unique<Of>(std::move(function));
}

/// The order in which effects act, whatever the order of the request. Between kParameters and kForce the
/// constitutive law is evaluated on what the first two left.
enum class EffectStage : std::uint8_t { kInput, kParameters, kForce, kSensorDynamics, kSensorStatics };

/// Natural sizes of a run, by which one range fits every scenario. A run without contact has no force but the sd of its
/// noise, and its depth is its longest way from the surface.
enum class EffectScale : std::uint8_t {
  kOne,
  kDuration,         ///< s, of the run.
  kForce,            ///< N, rms of the contact force while in contact.
  kForcePeak,        ///< N.
  kDepth,            ///< m, deepest indentation.
  kSpeed,            ///< m/s, rms.
  kForcePerSpeed,    ///< N s/m.
  kForcePerSpeedSq,  ///< N s^2/m^2.
  kForcePerAccel,    ///< kg.
  kForcePerDepth,    ///< N/m.
};
inline constexpr int kNumEffectScales = 10;
using EffectScales = std::array<double, kNumEffectScales>;

/// One parameter of an effect, its range in units of a natural size of the run.
struct EffectParameter {
  std::string name, unit;
  EffectScale scale = EffectScale::kOne;
  double lo = 0.0, hi = 0.0;  ///< Drawn log-uniformly, uniformly when lo <= 0.
  bool either_sign = false;   ///< The sign is drawn, too.
};

/// How the formula stands to the one that a diagnosis would use for the name.
enum class FormulaKind : std::uint8_t {
  kCatalogue,  ///< The same formula.
  kVariant,    ///< The same physics, another formula.
  kOutside,    ///< An effect that no catalogue names.
};
[[nodiscard]] const char* FormulaKindName(FormulaKind kind) noexcept;

/// Times that an effect may need besides its parameters.
struct EffectTiming {
  double dt_s = 0.0;        ///< Sample interval.
  double duration_s = 0.0;  ///< Of the run.
};

/// Everything there is to know about an effect. A new one is one object of this type in its family's list.
struct EffectSpec {
  std::string name, variant;
  FormulaKind kind = FormulaKind::kCatalogue;
  std::string formula;  ///< In the parameters' names.
  EffectStage stage = EffectStage::kForce;
  bool mode_gates = false;  ///< It makes physical sense in contact only, or in free motion only.
  /// The first is the strength; its range runs from the weakest to the strongest, which may be the smaller value.
  std::vector<EffectParameter> parameters;
  std::unique_ptr<Effect> (*make)(const std::vector<double>& values, const EffectTiming& timing) = nullptr;
  /// Instead of make, for an effect inside the plant's equations.
  std::unique_ptr<InnerEffect> (*make_inner)(const std::vector<double>& values, const EffectTiming& timing) = nullptr;
};

/// All effects of a family of plants, in a fixed order; none for a family that offers none.
[[nodiscard]] const std::vector<EffectSpec>& EffectRegistry(const PlantFamily& family);
/// The effect of that name and formula, or nullptr.
[[nodiscard]] const EffectSpec* FindEffectSpec(const PlantFamily& family, const std::string& name,
                                               const std::string& variant);
/// Names of a family's effects, each once.
[[nodiscard]] std::vector<std::string> EffectNames(const PlantFamily& family);

}  // namespace armcmc::plant_sim
