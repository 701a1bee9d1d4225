#pragma once

#include <memory>
#include <optional>
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

/// Basis functions of one variable, for localising the misfit and for testing whether any remains.
struct FeatureGroup {
  std::string name;  ///< In plain words.
  Matrix columns;
};

/// A variable against which a report plots the residual, and in which an unnamed misfit is described.
struct PlotFeature {
  std::string title;   ///< With unit.
  Vector value;        ///< SI
  std::string symbol;  ///< In expressions: "x".
};

/// A variable by which the recording is split, with the words for both sides.
struct SplitVariable {
  Vector value;
  std::string below, above;  ///< "in free motion"; for numbers with %s in place of the threshold.
  std::vector<double> thresholds;
};
/// Nine quantiles as thresholds.
[[nodiscard]] std::vector<double> SplitQuantiles(const Vector& series);

/// Whether a recording is suitable for an equation.
struct Suitability {
  bool can_name = true;
  std::string note;               ///< The reason if not, with numbers.
  bool needs_excitation = false;  ///< Another experiment would help: Equation::Separate proposes it.
};

struct Analysis;
struct Candidate;
using CandidatePtr = std::shared_ptr<Candidate>;

/// One measured output of a plant family and the law that predicts it. The engine knows a plant only through this
/// class.
///
/// A new plant is one class that implements this; the engine does not change.
class Equation {
 public:
  Equation() = default;
  Equation(const Equation&) = delete;
  Equation& operator=(const Equation&) = delete;
  virtual ~Equation() = default;

  /// The name in scenario files.
  [[nodiscard]] virtual std::string plant() const = 0;
  /// "flow law": where a plant has several equations. Empty: it has one.
  [[nodiscard]] virtual std::string name() const { return {}; }
  [[nodiscard]] virtual std::string output_name() const = 0;           ///< "force"
  [[nodiscard]] virtual std::string output_unit() const = 0;           ///< "N"
  [[nodiscard]] virtual std::vector<std::string> columns() const = 0;  ///< Time first, output last.
  [[nodiscard]] virtual std::string active_name() const = 0;           ///< "contact"
  [[nodiscard]] virtual std::string passive_name() const = 0;          ///< "free motion"

  /// @param window  Samples of the smoother.
  /// @throws std::invalid_argument, with the reason, if the recording is unsuitable for the law.
  [[nodiscard]] virtual Signals Prepare(const Recording& recording, int window) const = 0;
  /// Inputs of another recording, scaled as those of `like`.
  [[nodiscard]] virtual Signals PrepareLike(const Recording& recording, int window, const Signals& like) const = 0;

  /// Whether the estimator can run effects of this equation.
  [[nodiscard]] virtual bool online() const { return true; }
  /// Converts the base parameters of Report() to the estimator's priors. By default they have the same names
  /// in the same order.
  virtual void SetPriors(const std::vector<ParameterEstimate>& base, EstimatorSettings* settings) const;
  /// Checked before anything is named.
  [[nodiscard]] virtual Suitability Check(const Signals& signals) const {
    (void)signals;
    return {};
  }

  /// Coordinates of the law.
  [[nodiscard]] virtual std::vector<Coordinate> base(const Signals& signals) const = 0;
  /// Columns whose motion limits the window of the smoother; none: the widest window is used.
  [[nodiscard]] virtual std::vector<std::string> smoothed_columns() const { return {}; }
  /// Starting point of a fit.
  [[nodiscard]] virtual Vector Start(const Signals& signals) const = 0;
  /// The law at `theta`; fills columns [0, base) and those of the slopes. The jacobian is sized by the caller.
  virtual void Law(const Signals& signals, const double* theta, const LawInput& input, Prediction* out) const = 0;
  /// Parameters in the user's terms (K, B, p) with standard deviations by linear propagation.
  [[nodiscard]] virtual std::vector<ParameterEstimate> Report(const Signals& signals, const Vector& theta,
                                                              const Matrix& covariance) const = 0;

  [[nodiscard]] virtual std::vector<EffectForm> Catalogue(const Signals& signals) const = 0;
  /// A smooth error of the law, with `places` basis functions along each of its variables (law_error.hpp). None: the
  /// effects are smooth functions of the same variables, or the data do not show the law.
  [[nodiscard]] virtual std::optional<EffectForm> LawError(const Signals& signals, int places) const {
    (void)signals, (void)places;
    return std::nullopt;
  }
  /// Groups of the flexible residual model; `predicted` is the prediction of the base model.
  [[nodiscard]] virtual std::vector<FeatureGroup> Groups(const Signals& signals, const Vector& predicted) const = 0;
  [[nodiscard]] virtual std::vector<PlotFeature> PlotFeatures(const Signals& signals) const = 0;
  /// Variables that describe the regions of the misfit.
  [[nodiscard]] virtual std::vector<SplitVariable> SplitVariables(const Signals& signals) const;
  /// The experiment that separates candidates best, with the plant's scenario; without candidates, one that makes the
  /// equation identifiable.
  [[nodiscard]] virtual Experiment Separate(const Analysis& analysis,
                                            const std::vector<CandidatePtr>& candidates) const;
};

/// The equations of a built-in model: each is diagnosed on the same recording.
/// @throws std::invalid_argument listing the available models.
[[nodiscard]] std::vector<std::unique_ptr<Equation>> MakeEquations(const std::string& model);
/// The equation of a model with a single one.
/// @throws std::invalid_argument for any other.
[[nodiscard]] std::unique_ptr<Equation> MakeEquation(const std::string& model);
/// The columns that the equations of a model read, time first.
[[nodiscard]] std::vector<std::string> ColumnsOf(const std::string& model);

}  // namespace armcmc::gap
