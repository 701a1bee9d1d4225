#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/plant_sim/options.hpp"
#include "armcmc/plant_sim/schedule.hpp"

namespace armcmc::plant_sim {

inline constexpr int kMaxInputs = 4;  ///< Columns of data_pack_t.u.
inline constexpr int kMaxTruth = 8;   ///< Entries of plant_truth_t.theta_true.
inline constexpr int kMaxModes = 4;   ///< Identified modes, as in estimate_t.

/// One sampling instant. The same shape holds what is true and what the sensors say.
struct PlantSample {
  double t_s = 0.0;                         ///< Plant time, s.
  int mode = 0;                             ///< Identified mode that acts, or the number of modes when none does.
  std::array<double, kMaxInputs> inputs{};  ///< Order of PlantFamily::inputs.
  double output = 0.0;                      ///< data_pack_t.y.
};

/// Parameters as an estimator reports them for one mode, order of PlantFamily::truth_names.
using Theta = std::array<double, kMaxTruth>;

class GapMeter;
struct EffectSpec;
struct EffectTiming;
struct HiddenEffect;
struct ModelForm;
struct Scenario;

/// A plant with its own equations. It knows its parameters; nobody else does.
class Plant {
 public:
  virtual ~Plant() = default;

  /// Puts effects that act inside the equations into them, before the first instant; leaves the others alone.
  virtual void Hide(const std::vector<HiddenEffect>& /*effects*/, const EffectTiming& /*timing*/) {}

  /// The next instant, free of sensor noise: the first call gives t = 0, each further one t + T.
  /// @rt No heap, no lock, no throw.
  virtual void Advance(PlantSample* sample) noexcept = 0;

  /// True parameters of an identified mode at plant time t_s.
  [[nodiscard]] virtual Theta Truth(int mode, double t_s) const noexcept = 0;
  /// Regression target (contact force, valve flow) that parameters predict at a sample; 0 when no mode acts.
  [[nodiscard]] virtual double Predict(const Theta& theta, const PlantSample& sample) const noexcept = 0;
  /// What the plant answers with with those parameters: where its law is not quite the formula, not what Predict says.
  [[nodiscard]] virtual double Respond(const Theta& theta, const PlantSample& sample) const noexcept {
    return Predict(theta, sample);
  }
  /// Regression target that a sample shows by itself.
  [[nodiscard]] virtual double Target(const PlantSample& sample) const noexcept = 0;
};

struct ChannelSpec {
  std::string name;
  std::string unit;
};

struct ParameterSpec {
  std::string name;
  std::string unit;
  double lo = 0.0, hi = 0.0;  ///< What a scenario may ask for.
  std::string power = {};     ///< The exponent parameter whose power of the depth the unit holds; empty: none.
};

/// How the prediction of the regression target is reported.
struct TargetSpec {
  std::string column;     ///< Name of the true target in a CSV file.
  std::string clean_key;  ///< Report key of the mean absolute error against the true target.
  double clean_scale = 1.0;
  std::string noisy_key;  ///< Report key of the L2 norm of the error against the measured target.
};

/// What a plant is made from.
struct PlantSetup {
  const Schedule& schedule;
  const Options& options;
  double sample_interval_s;
  std::uint64_t seed = 1;  ///< Of a motion that is drawn.
};

/// Everything the rest of the simulation needs to know about a family of plants. A new family is one
/// object of this type in the registry.
struct PlantFamily {
  std::string name;
  std::int32_t kind = 0;  ///< data_pack_t.PLANT_*.
  std::vector<ChannelSpec> inputs;
  ChannelSpec output;
  std::vector<ParameterSpec> parameters;  ///< Of the scenario file, in the order of the schedule.
  std::vector<OptionSpec> options;
  std::vector<std::string> modes;        ///< Identified modes.
  std::vector<std::string> truth_names;  ///< Parameters of a mode as estimators report them.
  TargetSpec target;
  /// @throws std::invalid_argument when options contradict each other.
  std::unique_ptr<Plant> (*make)(const PlantSetup& setup) = nullptr;
  bool makes_contact = false;  ///< Effects may act in contact only, or in free motion only.
  /// What can be hidden in it, in a fixed order; null: nothing.
  const std::vector<EffectSpec>& (*effects)() = nullptr;
  /// See MakeGapMeter(); of a family that has effects.
  std::unique_ptr<GapMeter> (*make_gap_meter)(const Scenario& scenario) = nullptr;
  const ModelForm& (*model_form)() = nullptr;  ///< Null: no model file becomes one.

  [[nodiscard]] int num_inputs() const noexcept { return static_cast<int>(inputs.size()); }
  [[nodiscard]] int num_modes() const noexcept { return static_cast<int>(modes.size()); }
  [[nodiscard]] int num_truth() const noexcept { return static_cast<int>(truth_names.size()); }
};

/// All families, in the order in which messages list them.
[[nodiscard]] const std::vector<const PlantFamily*>& PlantRegistry();
/// The default scenario.
[[nodiscard]] std::string DefaultScenario();
/// The family of that name, or nullptr.
[[nodiscard]] const PlantFamily* FindPlantFamily(const std::string& name);

}  // namespace armcmc::plant_sim
