#pragma once

#include <string>
#include <vector>

#include "armcmc/data_pack.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::bench {

/// Described contact laws that differ in the number D of their parameters, for how the step grows with it:
///
///   D = 2   (K + B v) x^1.5             an exponent that is known
///   D = 3   (K + B v) x^p
///   D = 4   (K + B v) x^p + c           an offset of the force sensor, N
///   D = 5   K x^p + B v x^q + c         damping with an exponent of its own: a second power for each sample
///   D = 6   K x^p + B v x^q + c + m a   an inertia, kg
inline constexpr int kFewestLawParameters = 2, kMostLawParameters = 6;

/// The plant file of that law. @throws std::out_of_range for another D.
[[nodiscard]] std::string LawText(int num_parameters);

/// Settings of the estimator with the priors and the noise of that file. @throws std::out_of_range for another D.
[[nodiscard]] EstimatorSettings LawSettings(int num_parameters);

/// Packs of K = 4, B = 2.3, p = 1.7, c = 0.2 N, q = 1.4, m = 5 g, 1 kHz, with Gaussian noise of 5 mN. Equal arguments
/// give equal packs on every machine.
/// @param settings  LawSettings(num_parameters).
[[nodiscard]] std::vector<DataPack> LawPacks(int num_parameters, const EstimatorSettings& settings, int count,
                                             int samples);

}  // namespace armcmc::bench
