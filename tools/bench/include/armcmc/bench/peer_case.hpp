#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "armcmc/data_pack.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::bench {

/// One pack from the prior of the settings, a task that any sampler can be given.
struct PeerCase {
  std::string name;
  EstimatorSettings settings;
  DataPack pack;
};

/// The cases of BM_EffectiveDraws that start from the prior: `cold` and `ridge`, with the same packs.
[[nodiscard]] std::vector<PeerCase> PeerCases();

/// Moments of one parameter's posterior.
struct Moments {
  double mean = 0.0, sd = 0.0;
};

/// Posterior of K, B and p of a press given one pack and normal priors, by quadrature:
///
///   p(K, B, p | y)  ~  N(K; .) N(B; .) N(p; .) prod_n N(y_n; (K + B v_n) x_n^p, noise^2)
///
/// Given p it is normal in (K, B), with moments in closed form; p is summed over 4001 nodes, twelve standard deviations
/// to either side of its mean. The box of the prior must hold the posterior: bounds are not integrated over.
/// @throws std::invalid_argument where a bound is less than six posterior standard deviations from the mean, or a prior
/// is not normal.
[[nodiscard]] std::array<Moments, 3> QuadraturePosterior(const PeerCase& what);

/// Writes the cases for programs in other languages, and what the estimator makes of them, one folder for each:
///
///   CASE/pack.csv        x, v, f, noise_sd: one row for each sample
///   CASE/parameters.csv  name, mean, sd, lower, upper, posterior_mean, posterior_sd: the normal prior, cut at its
///                        bounds, and the posterior by quadrature
///   CASE/armcmc_weighted.csv, CASE/armcmc_chain.csv  ms, acceptance, evaluations, K, B, p: one row for each replicate,
///                        whose seed of the draws is its own; time of a whole step, and estimated posterior means
///
/// Numbers have 17 digits. @throws std::runtime_error when a file cannot be written.
void WritePeerCases(const std::filesystem::path& folder, int replicates);

}  // namespace armcmc::bench
