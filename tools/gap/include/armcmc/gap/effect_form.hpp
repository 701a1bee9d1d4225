#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/gap/coordinate.hpp"
#include "armcmc/gap/form_input.hpp"
#include "armcmc/gap/prediction.hpp"
#include "armcmc/gap/signals.hpp"
#include "armcmc/gap/types.hpp"
#include "armcmc/identify/lane_program.hpp"

namespace armcmc::gap {

/// Where an effect acts; also the order of evaluation, the same as in the estimator.
enum class Slot : std::uint8_t {
  kInputMap,   ///< Shifts the position before the law is evaluated.
  kParameter,  ///< Scales the law's first parameter.
  kDrive,      ///< Adds to the input that drives the plant.
  kForce,      ///< Adds an acceleration that depends on the state which the law simulates.
  kMemory,     ///< Adds a filtered copy of the law's elastic part.
  kAdditive,   ///< Adds amplitudes x features of the inputs.
  kDelay,      ///< Acts on the series of outputs: dead time first,
  kLag,        ///< then low passes,
  kStatics,    ///< then a map of each output.
};

/// Simulated motions at one sample, side by side: what a form may read of them, the rest zero.
struct Motions {
  /// By FormSignal: angle, rad; rate, rad/s; drive and base, rad/s^2; time, s. Then room for the states of a form.
  std::array<identify::Lanes, static_cast<std::size_t>(kFirstPast)> input{};

  [[nodiscard]] identify::Lanes& at(FormSignal signal) { return input[static_cast<std::size_t>(signal)]; }
  [[nodiscard]] const identify::Lanes& at(FormSignal signal) const { return input[static_cast<std::size_t>(signal)]; }
};

/// An effect in simulated motions on their way.
class MotionForce {
 public:
  MotionForce() = default;
  MotionForce(const MotionForce&) = delete;
  MotionForce& operator=(const MotionForce&) = delete;
  virtual ~MotionForce() = default;

  /// Moves what it remembers by one sample; called once a sample, before At().
  virtual void Move(Motions* motions) = 0;
  /// The acceleration in a state.
  virtual void At(Motions* motions, identify::Lanes* acceleration) = 0;
};

/// One formula of one effect of the catalogue, scaled to a recording.
///
/// An effect has the catalogue's formula and may have variants: other formulas for the same physics. If a variant fits
/// best, the effect is named with the formula marked as approximate.
struct EffectForm {
  std::string effect;   ///< Name in the catalogue.
  std::string variant;  ///< Empty: the catalogue's own formula.
  std::string family;
  std::string formula;
  bool listed = true;  ///< Whether it belongs to the catalogue. An unlisted effect is never named: it competes with
                       ///< the others, so that nothing is named that it explains better.
  std::string plain_error;  ///< What it is called as an error of the model or of its data, so plain that it competes,
                            ///< unlisted, even where it is excluded from the catalogue; empty: it is left out there.
  bool regular = false;     ///< Many small amplitudes, fitted with their prior (ridge regression).
  Slot slot = Slot::kAdditive;
  std::vector<Coordinate> coordinates;      ///< Amplitudes first, then shapes.
  int num_amplitudes = 1;                   ///< Coordinates that multiply features.
  bool linear = true;                       ///< The prediction is linear in the amplitudes, given the shapes.
  bool from_surface = false;                ///< Features use the position as the law does, after input maps.
  bool gates_by_mode = false;               ///< May act in contact or in free motion only.
  bool gates_by_time = true;                ///< May start or end during the recording.
  std::vector<std::vector<double>> starts;  ///< Coordinates to start fits from.
  std::vector<std::string> own_groups;      ///< Feature groups in which a different formula of the effect may act.

  /// Further starts, which depend on the residual; may be null.
  std::function<std::vector<std::vector<double>>(const Signals&, const Vector& whitened_residual)> find_starts;
  /// kAdditive, kInputMap, kParameter, kDrive: the columns that the amplitudes multiply, [row][amplitude], from the
  /// shapes. Without amplitudes: the single column that is added.
  std::function<Matrix(const Signals&, const double* shape)> features;
  /// kForce: itself in motions that begin, from the values of all coordinates, [coordinate], and the sample interval, s.
  std::function<std::unique_ptr<MotionForce>(const std::vector<identify::Lanes>& values, double dt)> force;
  /// kMemory: filters a series by the shapes; one filter per amplitude.
  std::function<Vector(const Signals&, const Vector& series, int amplitude, const double* shape)> filter;
  /// kDelay, kLag, kStatics: acts on a prediction; own columns from `first` on.
  std::function<void(const Signals&, const double* coordinates, int first, Prediction*)> sense;

  [[nodiscard]] int size() const { return static_cast<int>(coordinates.size()); }
  [[nodiscard]] bool exact() const { return variant.empty() && listed; }
};

}  // namespace armcmc::gap
