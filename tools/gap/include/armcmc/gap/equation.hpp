#pragma once

#include <memory>
#include <string>
#include <vector>

#include "armcmc/gap/coordinate.hpp"
#include "armcmc/gap/effect_form.hpp"
#include "armcmc/gap/prediction.hpp"
#include "armcmc/gap/recording.hpp"
#include "armcmc/gap/result.hpp"
#include "armcmc/gap/signals.hpp"

namespace armcmc::gap {

/// Columns that one variable explains, for finding where a gap lives and for judging whether anything is left.
struct FeatureGroup {
  std::string name;  ///< As a person would say it.
  Matrix columns;
};

/// A variable that a report plots the residual against.
struct PlotFeature {
  std::string title;  ///< With unit.
  Vector value;
};

/// One measured output of a plant family and the law that predicts it: everything that the engine knows about a plant.
///
/// A new plant is one class that implements this; the engine does not change.
class Equation {
 public:
  Equation() = default;
  Equation(const Equation&) = delete;
  Equation& operator=(const Equation&) = delete;
  virtual ~Equation() = default;

  [[nodiscard]] virtual std::string output_name() const = 0;           ///< "force"
  [[nodiscard]] virtual std::string output_unit() const = 0;           ///< "N"
  [[nodiscard]] virtual std::vector<std::string> columns() const = 0;  ///< Time first, output last.
  [[nodiscard]] virtual std::string active_name() const = 0;           ///< "contact"
  [[nodiscard]] virtual std::string passive_name() const = 0;          ///< "free motion"

  /// @param window  Samples of the smoother.
  /// @throws std::invalid_argument when the recording cannot say anything on the law; says why.
  [[nodiscard]] virtual Signals Prepare(const Recording& recording, int window) const = 0;
  /// Inputs of another recording, scaled as those of `like`.
  [[nodiscard]] virtual Signals PrepareLike(const Recording& recording, int window, const Signals& like) const = 0;

  /// Coordinates of the law.
  [[nodiscard]] virtual std::vector<Coordinate> base(const Signals& signals) const = 0;
  /// Where a fit starts.
  [[nodiscard]] virtual Vector Start(const Signals& signals) const = 0;
  /// The law at `theta`; fills columns [0, base) and those of the slopes. The jacobian is sized by the caller.
  virtual void Law(const Signals& signals, const double* theta, const LawInput& input, Prediction* out) const = 0;
  /// Parameters in the user's terms (K, B, p) with standard deviations by linear propagation.
  [[nodiscard]] virtual std::vector<ParameterEstimate> Report(const Signals& signals, const Vector& theta,
                                                              const Matrix& covariance) const = 0;

  [[nodiscard]] virtual std::vector<EffectForm> Catalogue(const Signals& signals) const = 0;
  /// Groups of the flexible residual model; `predicted` is what the base model says.
  [[nodiscard]] virtual std::vector<FeatureGroup> Groups(const Signals& signals, const Vector& predicted) const = 0;
  [[nodiscard]] virtual std::vector<PlotFeature> PlotFeatures(const Signals& signals) const = 0;
};

/// The equation of a built-in model.
/// @throws std::invalid_argument listing the models that there are.
[[nodiscard]] std::unique_ptr<Equation> MakeEquation(const std::string& model);

}  // namespace armcmc::gap
