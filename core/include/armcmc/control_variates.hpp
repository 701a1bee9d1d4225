#pragma once

#include <array>

#include "armcmc/laplace.hpp"
#include "armcmc/marginal_table.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

namespace simd {
struct Kernels;
}

/// Draws from a proposal q with importance weights w. Rows padded to whole vectors (8), as the kernels read them.
struct ProposalDraws {
  int size = 0;
  std::array<const double*, kMaxParams> u{};
  const double* proposal = nullptr;  ///< q(u).
  double* weight = nullptr;          ///< Sum 1, >= 0.
};

/// Reduces the sampling error of importance weights by control variates.
///
/// With G, a Gaussian close to the target, and g = G / q, the means under q of
///
///   h_0 = g - 1,   h_d = g (u_d - m_d) / s_d,   h_ij = g (z_i z_j - v [i = j])
///
/// are exactly zero (m, s: mean and standard deviations of G; z: coordinates in which its covariance is v I). Their
/// averages over the draws are sampling error. The weights become
///
///   w_k (1 - lambda' h(u_k)),   lambda = (sum h h')^-1 sum h
///
/// the regression estimator: with w = c g, which is a Gaussian target, the means of linear and quadratic functions are
/// then known almost exactly, and for others the error shrinks by the root of 1 - R^2 of w f on h. A recursion needs
/// the quadratic ones: the sampling error of a covariance is handed on to every later posterior. In sum h h' the third
/// and fourth moments under g^2 are those of a normal law, which costs O(size dim^2) instead of O(size dim^4).
///
/// Consistent for any G; where G does not predict the target, lambda is near zero. Source: Owen and Zhou, Safe and
/// effective importance sampling, JASA 95 (2000); Deville and Saerndal, Calibration estimators in survey sampling, JASA
/// 87 (1992).
/// @param table    Law of G's coordinates, symmetric about 0.
/// @param scratch  2 x size, padded like the draws.
/// @return false, with the weights as they were, where g has less than a quarter of its effective draws: its
/// correction would be noise itself.
/// @rt No heap, no lock, no throw. O(size dim^2).
bool ReduceVariance(const simd::Kernels& kernels, const Gaussian& guide, const MarginalTable* table,
                    const ProposalDraws& draws, const std::array<double*, 2>& scratch) noexcept ARMCMC_NONBLOCKING;

}  // namespace armcmc
