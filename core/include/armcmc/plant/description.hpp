#pragma once

#include <optional>
#include <string>
#include <vector>

namespace armcmc {

/// A measured quantity: a column of packs and recordings.
struct SignalDescription {
  std::string name;           ///< Letters, digits and "_"; not that of a function.
  std::string unit;           ///< "N s/m^2"; "1": a pure number.
  std::string role;           ///< "position", "velocity", "force", ...: what effects of the catalogue require.
  std::string derivative_of;  ///< Signal that it is the rate of; empty: of none.
  std::string between = {};   ///< What it does between samples, for states: "linear" (or empty), "held" or "smooth".
};

/// A named number of the plant: [constants].
struct ConstantDescription {
  std::string name;
  double value = 0.0;
  std::string unit;  ///< Empty: fits everywhere.
};

/// A parameter with its prior, truncated to [lower, upper]: [parameters].
struct ParameterDescription {
  std::string name;
  std::string unit;
  std::string prior = "normal";                ///< "normal", "uniform" or "lognormal".
  double mean = 0.0;                           ///< For a lognormal prior: the median.
  double sd = 0.0;                             ///< For a lognormal prior: that of the logarithm.
  std::optional<double> lower = std::nullopt;  ///< Left out: 8 sd below the mean.
  std::optional<double> upper = std::nullopt;  ///< Left out: 8 sd above the mean.
  bool per_mode = false;                       ///< Each mode has a value of its own.
};

/// A named subexpression: [let]. It may use those defined before it.
struct LetDescription {
  std::string name;
  std::string text;
};

/// A mode of the plant: [[mode]]. At every sample, the first mode whose condition holds acts.
struct ModeDescription {
  std::string name;
  std::string when;      ///< Empty: always.
  std::string law;       ///< An expression; of a passive mode it may be empty: 0.
  std::string target;    ///< What the law explains, of signals; empty: the output.
  bool passive = false;  ///< Its samples carry no information about the parameters.
};

/// A state: [states]. Integrated with the inputs by the classical Runge-Kutta method of order 4, in `substeps` equal
/// steps for each sample interval.
struct StateDescription {
  std::string name;
  std::string unit;
  std::string role;
  std::string rate;         ///< d state/dt, an expression.
  std::string start;        ///< Expression of parameters and of signals at the first sample.
  std::string measured_by;  ///< Signal that each pack starts from; empty: none.
  int substeps = 1;         ///< Integration steps per sample interval.
};

/// An additional published quantity, computed from parameters and constants: [report].
struct ReportDescription {
  std::string name;
  std::string unit;
  std::string value;
};

/// Measurement noise of the quantity that the law explains: [noise].
struct NoiseDescription {
  std::string law = "gaussian";  ///< "gaussian", "student_t", "laplace" or "mixture".
  double std = 1.0;              ///< Unit of what is explained.
  bool estimate = false;         ///< Sample the standard deviation together with the parameters.
};

/// The content of a plant file, before any check of its meaning; see core/plants/README.md for the format. Lists are in
/// the order of the file. Plant checks it.
struct PlantDescription {
  std::string name;
  std::string title;
  std::string output;    ///< Signal that the law explains.
  std::string law;       ///< Law of the only mode; empty if `modes` is not.
  std::string predicts;  ///< What is shown as prediction of the output where modes explain a target.
  std::vector<SignalDescription> signals;
  std::vector<ConstantDescription> constants;
  std::vector<ParameterDescription> parameters;
  std::vector<LetDescription> lets;  ///< Each may use those before it.
  std::vector<ModeDescription> modes;
  std::vector<StateDescription> states;
  std::vector<ReportDescription> reports;
  NoiseDescription noise;
};

}  // namespace armcmc
