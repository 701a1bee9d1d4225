#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "armcmc/data_pack.hpp"
#include "armcmc/effects/effect.hpp"
#include "armcmc/gap_watch/gap_settings.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

class PlantProgram;
struct ModelInfo;

/// Initial prior P_0 of one parameter, before truncation to its bounds.
enum class PriorKind : std::uint8_t { kNormal, kUniform };

/// Prior and bounds of one parameter, in the parameter's unit.
struct ParameterSettings {
  std::string name;  ///< Must match a parameter of the model.
  PriorKind prior = PriorKind::kNormal;
  double mean = 0.0;    ///< Mean of the untruncated normal. Unused by kUniform.
  double sd = 1.0;      ///< > 0. Unused by kUniform.
  double lower = -1.0;  ///< Hard bounds, lower < upper. The prior is zero outside.
  double upper = 1.0;
};

/// Law of the measurement noise P_nu.
enum class NoiseKind : std::uint8_t { kGaussian, kStudentT, kLaplace, kMixture };

/// Noise of one mode. `std` is the scale of the law: the standard deviation (Gaussian), the scale of the
/// t law, the mean absolute deviation b (Laplace), the standard deviation of the inlier part (mixture).
struct NoiseSettings {
  NoiseKind kind = NoiseKind::kGaussian;
  /// > 0, unit of the regression target: that of the output for a law of the output, of a rate where that is regressed.
  double std = 1.0;
  double mean = 0.0;             ///< mu_nu, same unit.
  bool estimate_std = false;     ///< Sample the scale with theta, log-normal prior around `std`.
  double std_log_sd = 1.0;       ///< Prior standard deviation of log(scale) when it is estimated, > 0.
  double dof = 4.0;              ///< Student-t degrees of freedom, [1, 1000].
  double outlier_weight = 0.05;  ///< Mixture: probability of the wide part, [1e-6, 0.5].
  double outlier_scale = 10.0;   ///< Mixture: its standard deviation over `std`, > 1.
};

/// How the mismatch between the previous posterior and a new pack is measured (algorithm step 1).
enum class MismatchIndex : std::uint8_t {
  kSignedMean,     ///< Mean error over the noise scale: the paper's formula.
  kRms,            ///< Root mean squared error over the noise scale, minus what the posterior predictive expects.
  kLogPredictive,  ///< Loss of mean log posterior-predictive density against its expected value, in nats.
};

struct ForgettingSettings {
  MismatchIndex index = MismatchIndex::kRms;
  double threshold = 1.0;       ///< zeta_th > 0, in units of the noise scale (nats for kLogPredictive).
  double mu = 0.0;              ///< mu_nu of lambda = exp(-|mu_nu - zeta|), same unit as zeta.
  double lambda_max = 0.99999;  ///< In (0, 1): a change is never considered impossible.
  double rho = 0.0;             ///< In [0, 1]: weight exp(-rho (N_s - n)) of the error of sample n.
  int min_samples = 3;          ///< Packs with fewer informative samples of a mode hold its posterior, >= 1.
  double drift_share =
      0.04;  ///< Prior probability of drift, in [0, 1). 0: parameters are constant or jump, as published.
  bool partial_change = true;  ///< A modification may keep all parameters but one; false: P_0 alone, as published.
};

/// Which number of draws a pack gets.
enum class DrawRule : std::uint8_t { kChernoff, kKMin, kFixed };

struct SamplerSettings {
  double epsilon = 0.01;  ///< Precision in (0, 1).
  double delta = 0.9;     ///< Reliability in (0, 1).
  DrawRule rule = DrawRule::kChernoff;
  int fixed_draws = 5000;       ///< For kFixed, [kMinDraws, max_draws].
  int max_draws = 16'384;       ///< Size of the workspace and upper bound of any rule, [kMinDraws, kMaxDraws].
  double lambda_q_min = 0.05;   ///< Share of pilot candidates from the previous posterior: lambda clamped to
  double lambda_q_max = 0.5;    ///< [lambda_q_min, lambda_q_max], both in (0, 1). Once fitted, fewer, not below min.
  std::uint64_t seed = 0x5eed;  ///< Fixed by default; never taken from the machine.
  bool use_proposal_ratio =
      true;  ///< false drops q from the acceptance ratio: wrong on purpose, for calibration tests.
  /// Where the law is linear in all parameters but one, or two that no term needs both of, and the noise Gaussian:
  /// candidates are scored by sums over the samples (QuadraticScore). false: each against every sample.
  bool use_linearity = true;
  static constexpr int kMinDraws = 200;
};

/// The method that turns packs into a posterior.
enum class Method : std::uint8_t {
  kArmcmc,
  kRls,             ///< Recursive least squares; the built-in contact law is log-linearised, described ones linearised.
  kParticleFilter,  ///< Random-walk state, tempered updates, systematic resampling.
  kMetropolis,      ///< Plain random-walk Metropolis-Hastings on each pack alone.
};

/// Tuning of the baselines: one setting for all scenarios, as for the estimator.
struct BaselineSettings {
  /// One vector of parameters for each mode, kept while the other modes act. false, as published: one vector, which
  /// restarts when the mode changes.
  bool recall = false;
  double rls_forgetting = 0.9997;  ///< Per sample, in (0, 1].
  bool rls_reset = true;           ///< Contact: the covariance is reset at every contact; the estimates remain.
  int particles = 4096;            ///< [kMinDraws, max_draws].
  int pf_updates = 1;       ///< Updates per pack, [1, kMaxPackSamples]: the samples are divided into as many runs.
  double pf_jitter = 0.05;  ///< Random walk of a parameter, prior standard deviations per pack, >= 0.
};

inline constexpr int kMaxConstants = 8;  ///< Constants of one compiled plant.
/// Constants that are known, not estimated: as many as the compiled plant declares (CompiledPlant::constants), in its
/// order. Those of a described plant stand in its file.
using PlantConstants = std::array<double, kMaxConstants>;

/// When an effect acts.
enum class EffectGate : std::uint8_t {
  kAlways,
  kContact,  ///< While the measured x >= 0; of a plant that has contact only.
  kFree,     ///< While it is not; of a plant that has contact only.
  kFrom,     ///< From plant time from_s on.
  kUntil,    ///< Before plant time until_s.
};

/// One effect added to the model: its amplitudes are estimated with the parameters, its shapes are frozen.
struct EffectSettings {
  std::string name;  ///< Name in the catalogue of the plant; see CompiledPlant.
  EffectGate gate = EffectGate::kAlways;
  double from_s = 0.0;                                             ///< For kFrom, s.
  double until_s = 0.0;                                            ///< For kUntil, s.
  std::array<ParameterSettings, kMaxEffectAmplitudes> amplitudes;  ///< Named as in the catalogue.
  std::array<double, kMaxEffectShapes> shapes{};                   ///< In the order of the catalogue.
};

/// Everything that decides what the estimator computes. Build it by hand, from a built-in model
/// (BuiltinSettings), or from a configuration file.
struct EstimatorSettings {
  std::string model;                                     ///< See CompiledModels(); of a described plant its name.
  std::shared_ptr<const PlantProgram> plant;             ///< Described by a file; null: built in.
  std::array<ParameterSettings, kMaxParams> parameters;  ///< Shared by all modes; the first num_parameters count.
  int num_parameters = 0;
  std::array<NoiseSettings, kMaxModes> noise;  ///< Per mode.
  ForgettingSettings forgetting;
  SamplerSettings sampler;
  Method method = Method::kArmcmc;
  BaselineSettings baseline;
  PlantConstants constants{};
  /// For a plant that has a `rate_unit` (CompiledPlant): the rate that the law divides by is regressed instead of
  /// the law's own target, for data whose noise is that of the rate's sensor: in the target that noise multiplies the
  /// unknown parameters, which biases them, and does not show how precise a sample is. Effects of such a plant are
  /// always estimated in this way.
  bool regress_rate = false;
  std::array<EffectSettings, kMaxEffects> effects;  ///< Each at most once.
  int num_effects = 0;
  GapWatchSettings gap_watch;  ///< Changes no estimate.
  /// L, in [1, kMaxPackSamples]: a pack shares samples with the L - 1 before it, and its window begins where that of
  /// the pack seq - L ended. An Estimator gets every L-th pack, so that it counts a sample once; InterleavedEstimator
  /// distributes them. The samples of a pack are a multiple of L.
  int overlap = 1;

  /// @throws std::invalid_argument naming the key, its value and the allowed range.
  void Validate() const;
};

/// Settings of a built-in model with its default priors, bounds and noise.
/// @throws std::invalid_argument listing the known names.
[[nodiscard]] EstimatorSettings BuiltinSettings(const std::string& model);

/// A constant of the compiled plant of these settings; NaN: it has none of that name.
[[nodiscard]] double ConstantOf(const EstimatorSettings& settings, std::string_view name) noexcept;

/// Settings of a described plant with the priors and the noise of its file.
[[nodiscard]] EstimatorSettings DescribedSettings(std::shared_ptr<const PlantProgram> plant);

/// An effect with the priors and typical shapes of a compiled plant's catalogue, for signals of these sizes, always on.
/// @throws std::invalid_argument listing the known names.
[[nodiscard]] EffectSettings MakeEffect(const ModelInfo& model, const std::string& name,
                                        const EffectScales& scales = {});

}  // namespace armcmc
