#pragma once

#include <array>
#include <string_view>

#include "armcmc/data_pack.hpp"
#include "armcmc/linear_part.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/settings.hpp"

namespace armcmc {

class PlantProgram;
struct CompiledPlant;

/// A parameter of a model with its built-in prior, a normal distribution truncated to the bounds.
struct ParameterInfo {
  /// As in messages and plant files; static storage, or as long as the plant.
  std::string_view name;
  std::string_view unit;  ///< As text; lifetime as that of the name.
  double mean, sd;        ///< Normal prior before truncation, in `unit`; sd > 0.
  double lower, upper;    ///< Bounds, in `unit`; lower < upper.
};

/// A published quantity: a parameter, or a function of the parameters.
struct ReportedInfo {
  std::string_view name;  ///< Lifetime as ParameterInfo::name.
  std::string_view unit;  ///< As text.
};

/// What the estimator has to know about a forward model F_j(X, theta_j), shared by all its modes. A plant file makes
/// one (PlantProgram), and so does the folder of a compiled plant (CompiledPlant).
///
/// Made at set-up and constant from then on, so that all stages may read it at the same time. The arrays are used up to
/// the number beside them.
struct ModelInfo {
  std::string_view name;         ///< As in configurations and messages.
  PlantNumber plant;             ///< kDescribed for a plant file.
  std::string_view target_unit;  ///< Unit of what is regressed.
  int num_parameters;            ///< Dimension of theta, 1 to kMaxParams.
  std::array<ParameterInfo, kMaxParams> parameters;
  int num_modes;                                      ///< 1 to kMaxModes.
  std::array<std::string_view, kMaxModes + 1> modes;  ///< The entry after the last is the passive mode.
  int num_inputs;                                     ///< Columns of u.
  double default_noise_std;                           ///< Unit of the target.
  int num_reported;                                   ///< 1 to kMaxReported.
  std::array<ReportedInfo, kMaxReported> reported;
  /// Mode that acts at sample n; num_modes if none does. @param n  In [0, pack.num_samples).
  int (*mode_of)(const DataPack& pack, int n) noexcept ARMCMC_NONBLOCKING;
  /// Computes the reported quantities from the model's own parameters. Null: the parameters themselves are reported.
  void (*report)(const double* theta, const PlantConstants& constants, double* reported) noexcept ARMCMC_NONBLOCKING;
  const CompiledPlant* compiled = nullptr;     ///< What else a compiled plant can do; null: a file describes it.
  const PlantProgram* described = nullptr;     ///< For a plant file: it reports, and has no mode_of.
  std::array<LinearPart, kMaxModes> linear{};  ///< Linear parameters of the law of each mode.
  int num_added = 0;  ///< Amplitudes of effects: the last of the parameters, and reported as they are, last.

  /// Index among the reported quantities of parameter d, which the model reports as it is. @rt O(1).
  [[nodiscard]] int ReportedOf(int d) const noexcept ARMCMC_NONBLOCKING {
    return d < num_parameters - num_added ? d : d + num_reported - num_parameters;
  }
  /// Reported quantities at theta.
  /// @param theta      num_parameters values, as they are sampled: of a lognormal parameter, the logarithm.
  /// @param constants  Of the compiled plants; a plant file has its constants in the program.
  /// @param values     Receives num_reported values, in the units of `reported`.
  /// @rt No heap, no lock, no throw.
  void Report(const double* theta, const PlantConstants& constants, double* values) const noexcept ARMCMC_NONBLOCKING;
  /// True where reported quantity r is the sampled parameter r.
  [[nodiscard]] bool IsReportedAsSampled(int r) const noexcept ARMCMC_NONBLOCKING;
  /// The sampled parameter d from its reported value, the inverse of Report() for parameters that are reported as they
  /// are or as their exponential. @rt No heap, no lock, no throw.
  [[nodiscard]] double Sampled(int d, double reported_value) const noexcept ARMCMC_NONBLOCKING;
};

}  // namespace armcmc
