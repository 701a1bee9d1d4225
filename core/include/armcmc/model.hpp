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
  std::string_view unit;
  double mean, sd;      ///< Normal prior before truncation.
  double lower, upper;  ///< Bounds.
};

/// A published quantity: a parameter, or a function of the parameters.
struct ReportedInfo {
  std::string_view name;
  std::string_view unit;
};

/// What the estimator has to know of a forward model F_j(X, theta_j), shared by all its modes. A plant file makes one
/// (PlantProgram), and so does the slice of a compiled plant (CompiledPlant).
struct ModelInfo {
  std::string_view name;
  PlantNumber plant;
  std::string_view target_unit;  ///< Unit of what is regressed.
  int num_parameters;
  std::array<ParameterInfo, kMaxParams> parameters;
  int num_modes;
  std::array<std::string_view, kMaxModes + 1> modes;  ///< The entry after the last is the passive mode.
  int num_inputs;                                     ///< Columns of u.
  double default_noise_std;                           ///< Unit of the target.
  int num_reported;
  std::array<ReportedInfo, kMaxReported> reported;
  /// Mode that acts at sample n; num_modes if none does.
  int (*mode_of)(const DataPack& pack, int n) noexcept ARMCMC_NONBLOCKING;
  /// Of the model's own parameters. Null: what is reported are the parameters themselves.
  void (*report)(const double* theta, const PlantConstants& constants, double* reported) noexcept ARMCMC_NONBLOCKING;
  const CompiledPlant* compiled = nullptr;     ///< What else a compiled plant can do; null: a file describes it.
  const PlantProgram* described = nullptr;     ///< Of a plant file: reports, and has no mode_of.
  std::array<LinearPart, kMaxModes> linear{};  ///< Of the law of each mode.
  int num_added = 0;  ///< Amplitudes of effects: the last of the parameters, and reported as they are, last.

  /// Index among the reported quantities of parameter d, which the model reports as it is.
  [[nodiscard]] int ReportedOf(int d) const noexcept ARMCMC_NONBLOCKING {
    return d < num_parameters - num_added ? d : d + num_reported - num_parameters;
  }
  /// Reported quantities at theta, kMaxReported at most. @rt No heap, no lock, no throw.
  void Report(const double* theta, const PlantConstants& constants, double* values) const noexcept ARMCMC_NONBLOCKING;
  /// True where reported quantity r is the sampled parameter r.
  [[nodiscard]] bool IsReportedAsSampled(int r) const noexcept ARMCMC_NONBLOCKING;
  /// The sampled parameter d from its reported value. @rt No heap, no lock, no throw.
  [[nodiscard]] double Sampled(int d, double reported_value) const noexcept ARMCMC_NONBLOCKING;
};

}  // namespace armcmc
