#pragma once

#include <string>
#include <utility>
#include <vector>

#include "armcmc/gap/curve.hpp"
#include "armcmc/gap/run.hpp"

namespace armcmc::gap {

/// Verdict of the diagnosis.
enum class Verdict {
  kNone,       ///< Nothing beyond the noise.
  kNamed,      ///< One set of effects explains the gap; all others are rejected.
  kAmbiguous,  ///< More than one set explains it equally well: `ambiguous_set`.
  kUnnamed,    ///< Something is missing that no effect of the catalogue explains.
};

/// When an effect acts.
struct When {
  enum class Kind { kAlways, kContact, kFree, kFrom, kUntil };
  Kind kind = Kind::kAlways;
  double time_s = 0.0;  ///< kFrom, kUntil: plant time.
};

/// Posterior of one parameter.
struct ParameterEstimate {
  std::string name;
  std::string unit;
  double mean = 0.0;
  double sd = 0.0;
  /// Names of parameters that could make up for a change of this one, so that `sd` is that of the prior more than of
  /// the data: see `determined`. Empty: determined by itself.
  std::vector<std::string> confounded_with{};
};

/// A combination of parameters that the data determine, although they do not determine each of its parameters.
struct Combination {
  std::string text;                     ///< "a + 0.5 b", or, of parameters fitted by logarithms, "a * b^0.5".
  std::vector<std::string> parameters;  ///< Names.
  double value = 0.0;
  double sd = 0.0;
  std::string unit;
};

/// An effect of the verdict. In an ambiguous verdict: of the most probable set.
struct EffectFinding {
  std::string name;    ///< In the catalogue.
  std::string family;  ///< "dry friction"
  double probability = 0.0;
  std::vector<ParameterEstimate> parameters;
  When when;
  bool approximate = false;    ///< The family is identified, but a flexible function fits better than the formula.
  bool provisional = false;    ///< Acts in too few separate events to be validated on data left out.
  std::string formula_text{};  ///< "f + force tanh(v / speed)"
};

/// One hypothesis of the search: the base model with a set of effects (none: the base model alone).
struct CandidateScore {
  std::vector<std::string> effects;  ///< "coulomb_friction", "force_bias from 4.25 s"
  double log_evidence = 0.0;         ///< Laplace, nats.
  double heldout_score = 0.0;        ///< Leave-block-out log score relative to the base model, nats.
  double probability = 0.0;
  double closed_fraction = 0.0;  ///< Share of the explainable gap that it closes, [0, 1].
};

/// Where the base model and the data disagree.
struct Where {
  std::string feature;           ///< "v", "time", "memory of the past"
  std::string region;            ///< In plain words: "in contact, v < 0". Empty: everywhere.
  double share_of_excess = 0.0;  ///< Of the squared error beyond the noise, [0, 1].
  double effect_size = 0.0;      ///< Share of the noise variance that the feature predicts on blocks left out.
  double p_value = 1.0;
};

/// Quality of the prediction of held-out data.
struct Fit {
  double rmse = 0.0;             ///< Unit of the output.
  double mae = 0.0;              ///< Unit of the output.
  double worst_1_percent = 0.0;  ///< 99 % quantile of the absolute error.
  double coverage95 = 0.0;       ///< Share of samples inside the 95 % predictive band.
  double whiteness = 0.0;  ///< Ljung-Box statistic of the whitened residual over its 25 degrees of freedom: 1 is white.
};

/// Fit of one regime of the plant.
struct ModeFit {
  std::string mode;
  int samples = 0;
  double rmse_before = 0.0, rmse_after = 0.0;
};

/// Fit of one held-out segment, if there are several.
struct SegmentFit {
  double from_s = 0.0, until_s = 0.0;
  long long samples = 0;
  double rmse_before = 0.0, rmse_after = 0.0;
};

/// The gap, before and after the effect was added, on held-out data.
struct GapSummary {
  std::string unit;
  Fit before, after;
  double noise_floor = 0.0;                    ///< Standard deviation that no model can explain.
  double closed_fraction = 0.0;                ///< (mse before - mse after) / (mse before - floor^2).
  double closed_low = 0.0, closed_high = 0.0;  ///< 95 % interval, bootstrap over blocks.
  std::vector<ModeFit> modes;
  std::vector<SegmentFit> stretches;  ///< Empty if there is only one, or too many to list.
  std::string control_effects;        ///< Negative control: the second-ranked effects, added instead.
  double control_closed_fraction = 0.0;
  double gap_ratio = 0.0;  ///< Rms misfit of the refitted base model, relative to the noise.
};

/// A parameter of the base model, without and with the added effects.
struct ParameterChange {
  ParameterEstimate before, after;
};

/// One term of the sum of simple terms that describes an unnamed misfit.
struct SparseTerm {
  std::string expression;  ///< "v |v|"
  double coefficient = 0.0;
  double share = 0.0;  ///< Share of the gap, on data left out.
};

/// Step time of the estimator with the model.
struct Budget {
  double adjust_ms_before = 0.0, adjust_ms_after = 0.0;
  double deadline_ms = 0.0;
  bool meets_deadline = true;
  bool measured = false;
};

/// The experiment that separates an ambiguous set.
struct Experiment {
  std::string words;
  std::string scenario_file;  ///< Relative to the output folder; empty if there is no tie.
  double nats = 0.0;          ///< Expected evidence between the closest pair.
  std::string program{};      ///< Motion of the plant's library.
  double pace = 1.0;          ///< Of the motion, 1 as in the library.
  double depth = 0.0;         ///< Depth of its deepest press, unit of the position.
  double sample_interval_s = 0.0;
  std::string scenario_text{};  ///< For the plant.
  Curve course{};               ///< Of the input that is moved, against time; empty: not shown.
  std::string course_title{};   ///< "q, m"
};

/// Residual against one feature, in bins.
struct FeatureFigure {
  std::string feature;  ///< Axis title with unit.
  Curve before, after;  ///< Mean residual with 95 % band.
  Curve effect;         ///< Contribution of the added effects; empty without any.
};

/// Excess error over two features.
struct MapFigure {
  std::string x_title, y_title, value_title;
  std::vector<double> x_edges, y_edges;
  std::vector<double> value;  ///< Row by row of y; NaN where there are no data.
};

/// An effect that was named and added, with all earlier ones refitted; or several that the data cannot distinguish.
struct LadderRung {
  /// Names; the first was added. Several that are needed together: "a + b".
  std::vector<std::string> effects;
  std::vector<std::string> parameters{};  ///< What the data determine: "Fc = 20.4 ± 0.1 N", "a + b = ..".
  double closed_fraction = 0.0;           ///< Share of the gap closed by all rungs so far, on held-out data.
  double heldout_error = 0.0;             ///< Rms on held-out data, unit of the output.
  double probability = 0.0;               ///< Probability that an effect of this family is present.
  double remainder_ratio = 0.0;           ///< Rms misfit that remains, relative to the noise.
  bool provisional = false;               ///< Acts in too few separate events to be validated.
};

/// The misfit that remains after the last rung.
struct Unexplained {
  double share = 0.0;  ///< Relative to the squared error of the base model beyond the noise.
  std::vector<Where> where;
  std::vector<SparseTerm> sparse;
};

/// A published result on the same data.
struct PublishedFigure {
  std::string what;
  double value = 0.0;
  std::string source;
};

/// Everything that the report plots.
struct Figures {
  std::string output_title;                           ///< "force, N"
  Curve measured, predicted_before, predicted_after;  ///< Against time.
  Curve residual_before, residual_after;              ///< Against time.
  double diagnosis_end_s = 0.0;                       ///< Data after this time are held out; NaN: a separate file is.
  std::vector<FeatureFigure> features;
  Curve spectrum_before, spectrum_after;  ///< Hz, power of the whitened residual over that of white noise.
  MapFigure where;
};

/// One run of the workflow.
struct Result {
  std::string version;
  std::string model;
  std::string data_file;
  std::string data_sha256;
  unsigned long long seed = 0;
  long long rows = 0;
  double dt = 0.0;
  std::vector<std::string> notes;  ///< For the reader: columns derived, rows skipped, aliases, limits.

  std::string equation;  ///< The equation that carries the gap. Empty: the plant has only one.

  Verdict verdict = Verdict::kNone;
  std::string sentence;  ///< The verdict in one sentence.
  double probability_none = 1.0;
  double probability_unnamed = 0.0;
  std::vector<EffectFinding> effects;
  /// Sets that explain it equally well. May contain two effects of one family together: a latency may be part delay,
  /// part lag.
  std::vector<std::vector<std::string>> ambiguous_set;
  Experiment separate_by;
  std::vector<CandidateScore> candidates;  ///< Most probable first.
  std::vector<Where> where;                ///< Largest effect size first.
  std::vector<std::string> aliases;        ///< Effects that these inputs cannot reveal.
  std::vector<SparseTerm> sparse;
  std::vector<LadderRung> ladder;  ///< In the order in which effects were named.
  bool complete = false;           ///< After the last rung, a flexible function finds no further misfit.
  Unexplained remainder;
  std::vector<PublishedFigure> published;
  double relative_before = 0.0, relative_after = 0.0;  ///< Held-out rms error relative to the rms of the output.
  GapSummary gap;
  std::vector<ParameterChange> parameters;
  std::vector<Combination> determined;  ///< With the added effects: in place of parameters that are confounded.
  std::vector<ParameterDrift> drift;    ///< Plant files only.
  RunAlong run;                         ///< Plant files only.
  Budget budget;
  std::string model_file;  ///< model.toml, relative to the output folder; empty when no effect was added.
  Figures figures;
  std::vector<std::pair<std::string, double>> seconds;  ///< Time of each step.
};

}  // namespace armcmc::gap
