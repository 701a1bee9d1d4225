#pragma once

#include "armcmc/estimate.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/noise_model.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/settings.hpp"

namespace armcmc {

/// Predictions of draws from the previous posterior, summed up for the mismatch index.
struct PredictiveMoments {
  int num_samples = 0;
  std::array<double, kMaxPackSamples> mean{};      ///< E[F(x_n, theta)] over the previous posterior.
  std::array<double, kMaxPackSamples> variance{};  ///< Its variance.
  double variance_of_mean = 0.0;                   ///< Variance over the draws of the mean prediction of the pack.
  double log_noise_sd = 0.0;  ///< Standard deviation of the log of the noise scale; 0: it is known.
};

/// Mismatch of a pack against the previous posterior (equation `bys5333`), and what it means.
struct Mismatch {
  double zeta = 0.0;       ///< The index, in noise scales (nats for log_predictive).
  double allowance = 0.0;  ///< Three standard deviations of zeta if nothing has changed.
  double threshold = 0.0;  ///< zeta_th / sqrt(share) + allowance; share: samples of the mode over those of the pack.
  double lambda = 0.0;     ///< exp(-sqrt(share) max(0, |mu_nu - zeta| - allowance)) <= lambda_max; 0 in a modification.
  Decision decision = Decision::kModification;
};

/// Mismatch index, decision and temporal forgetting factor (algorithm steps 1 and 2).
///
///   signed_mean     zeta = mean_n(y_n - E F_n) / s                                       (the paper's index)
///   rms             zeta = sqrt(mean_n D(e_n)) - sqrt(D_0 + I v),   D deviance of the noise law, e_n = y_n - E F_n,
///                   D_0 its expectation, I the Fisher information, v mean predictive variance / s^2
///   log_predictive  zeta = expected - actual mean log posterior-predictive density
///
/// The paper's lambda falls with any |zeta|, so pure noise causes forgetting: a pack of 3 samples has a standard
/// deviation of zeta of 0.4. Three standard deviations are therefore attributed to chance and not counted; this
/// includes a noise scale that was estimated too small by chance. rms and log_predictive count only a worse fit than
/// expected: a smaller one is not a reason to forget.
/// @rt No heap, no lock, no throw. O(samples).
[[nodiscard]] Mismatch EvaluateMismatch(const ForgettingSettings& settings, const NoiseModel& noise, double noise_scale,
                                        const ModeData& data,
                                        const PredictiveMoments& predictive) noexcept ARMCMC_NONBLOCKING;

}  // namespace armcmc
