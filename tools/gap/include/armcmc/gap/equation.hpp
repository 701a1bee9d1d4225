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
#include "armcmc/settings.hpp"

namespace armcmc::gap {

/// Columns that one variable explains, for finding where a gap lives and for judging whether anything is left.
struct FeatureGroup {
  std::string name;  ///< As a person would say it.
  Matrix columns;
};

/// A variable that a report plots the residual against, and that describes what has no name.
struct PlotFeature {
  std::string title;   ///< With unit.
  Vector value;        ///< SI
  std::string symbol;  ///< In expressions: "x".
};

/// A variable to split the recording by, with the words for both sides.
struct SplitVariable {
  Vector value;
  std::string below, above;  ///< "in free motion"; for numbers with %s in place of the threshold.
  std::vector<double> thresholds;
};
/// Nine quantiles, to split at.
[[nodiscard]] std::vector<double> SplitQuantiles(const Vector& series);

/// Whether a recording can say anything on an equation.
struct Suitability {
  bool can_name = true;
  std::string note;               ///< Why not, with numbers.
  bool needs_excitation = false;  ///< Another experiment would help: Equation::Separate proposes it.
};

struct Look;
struct Candidate;
using CandidatePtr = std::shared_ptr<Candidate>;

/// One measured output of a plant family and the law that predicts it: everything that the engine knows about a plant.
///
/// A new plant is one class that implements this; the engine does not change.
class Equation {
 public:
  Equation() = default;
  Equation(const Equation&) = delete;
  Equation& operator=(const Equation&) = delete;
  virtual ~Equation() = default;

  /// As scenario files call it.
  [[nodiscard]] virtual std::string plant() const = 0;
  /// "flow law": where a plant has several equations. Empty: it has one.
  [[nodiscard]] virtual std::string name() const { return {}; }
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

  /// Whether the estimator can run effects of this equation.
  [[nodiscard]] virtual bool online() const { return true; }
  /// Turns what Report() says of the base parameters into the estimator's priors. By default they have the same names
  /// in the same order.
  virtual void SetPriors(const std::vector<ParameterEstimate>& base, EstimatorSettings* settings) const;
  /// The gate before any naming.
  [[nodiscard]] virtual Suitability Check(const Signals& signals) const {
    (void)signals;
    return {};
  }

  /// Coordinates of the law.
  [[nodiscard]] virtual std::vector<Coordinate> base(const Signals& signals) const = 0;
  /// Columns whose motion bounds the window of the smoother; none: the widest window will do.
  [[nodiscard]] virtual std::vector<std::string> smoothed_columns() const { return {}; }
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
  /// What regions of disagreement are described by.
  [[nodiscard]] virtual std::vector<SplitVariable> SplitVariables(const Signals& signals) const;
  /// The experiment that separates candidates best, with the plant's scenario; without candidates, one that makes the
  /// equation identifiable.
  [[nodiscard]] virtual Experiment Separate(const Look& look, const std::vector<CandidatePtr>& candidates) const;
};

/// The equations of a built-in model: each is diagnosed on the same recording.
/// @throws std::invalid_argument listing the models that there are.
[[nodiscard]] std::vector<std::unique_ptr<Equation>> MakeEquations(const std::string& model);
/// The equation of a model that has one.
/// @throws std::invalid_argument for any other.
[[nodiscard]] std::unique_ptr<Equation> MakeEquation(const std::string& model);
/// The columns that the equations of a model read, time first.
[[nodiscard]] std::vector<std::string> ColumnsOf(const std::string& model);

}  // namespace armcmc::gap
