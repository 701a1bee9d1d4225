#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "armcmc/marginal_table.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

/// A density of the standardised parameters u that can be drawn and evaluated: a triangular map to independent
/// coordinates with tabulated marginals.
///
///   z   = W (u - mean)                                            whitening, widest axis first
///   c   = clamp(z_0, -kBendReach, kBendReach)
///   e_0 = z_0,   e_1 = z_1 - poly_1(c)
///   e_i = z_i - poly_i(c) - sum_{1<=j<i} a_ij e_j - b_i e_1 c - d_i e_1^2           i >= 2
///   x_i = (e_i exp(-alpha_i t - beta_i t^2) - center_i) / scale_i,   t = clamp(c, -kTaperReach, kTaperReach)
///   p(u) = |det W| prod_i m_i(x_i) / scale_i exp(-alpha_i t - beta_i t^2)
///
/// poly_i, of degree 5, straightens a bent ridge (poor excitation leaves K x^p nearly constant: a long, thin, curved
/// valley); alpha and beta let its thickness vary along it. With all of them zero and analytic marginals it is a
/// Gaussian or Student-t around a mode. Drawn by inverse CDF of each marginal, then forward substitution.
struct DensityBlock {
  static constexpr int kDegree = 5;
  /// Beyond, the polynomials are held constant. As far out as there may be a draw: a ridge that turns away from its fit
  /// in the tails leaves a few draws there with most of the weight.
  static constexpr double kBendReach = 5.0;
  static constexpr double kTaperReach = 3.5;  ///< The same for the thickness, whose parabola is known less well.
  using Row = std::array<double, kMaxParams>;

  int dim = 0;
  bool axis_aligned = false;  ///< W is the identity, which need not be multiplied by.
  bool bent = false;          ///< Any of poly, linear, cross, square is in use.
  bool tapered = false;       ///< Any of alpha, beta is in use; implies bent.
  Row mean{};
  std::array<Row, kMaxParams> whiten{};                            ///< W, row i at [i].
  std::array<Row, kMaxParams> unwhiten{};                          ///< W^-1
  std::array<std::array<double, kDegree + 1>, kMaxParams> poly{};  ///< Coefficients of c^0 .. c^5.
  std::array<Row, kMaxParams> linear{};                            ///< a_ij
  Row cross{};                                                     ///< b_i
  Row square{};                                                    ///< d_i
  std::array<std::array<double, 2>, kMaxParams> thickness{};       ///< alpha_i, beta_i; zero for i = 0.
  Row center{};
  Row scale{};
  std::array<const MarginalTable*, kMaxParams> marginal{};  ///< Not owned.
  double norm = 0.0;                                        ///< |det W| / prod scale.

  static double Clamped(double z0) noexcept { return std::min(std::max(z0, -kBendReach), kBendReach); }
  /// What is subtracted from z_i, given c and the straightened coordinates before i.
  [[nodiscard]] double BendAt(int i, double c, const double* e) const noexcept ARMCMC_NONBLOCKING;
  /// e = straightened coordinates of u.
  void Straighten(const double* u, double* e) const noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] bool Tapers(int i) const noexcept {
    const auto& t = thickness[static_cast<std::size_t>(i)];
    return t[0] != 0.0 || t[1] != 0.0;
  }
  static double ClampedForTaper(double c) noexcept { return std::min(std::max(c, -kTaperReach), kTaperReach); }
  /// alpha_i t + beta_i t^2.
  [[nodiscard]] double LogThickness(int i, double c) const noexcept {
    const auto& coefficient = thickness[static_cast<std::size_t>(i)];
    const double t = ClampedForTaper(c);
    return t * (coefficient[0] + t * coefficient[1]);
  }

  /// p(u); scalar reference of the batch kernel.
  [[nodiscard]] double Density(const double* u) const noexcept ARMCMC_NONBLOCKING;
  /// Maps dim uniforms in (0, 1) to a draw.
  void Draw(const double* uniforms, double* u) const noexcept ARMCMC_NONBLOCKING;
};

inline double DensityBlock::BendAt(int i, double c, const double* e) const noexcept {
  const auto ii = static_cast<std::size_t>(i);
  double s = poly[ii][kDegree];
  for (int k = kDegree - 1; k >= 0; --k) s = s * c + poly[ii][static_cast<std::size_t>(k)];
  if (i < 2) return s;
  s += e[1] * (cross[ii] * c + square[ii] * e[1]);
  for (int j = 1; j < i; ++j) s += linear[ii][static_cast<std::size_t>(j)] * e[j];
  return s;
}

// Inline: called for every candidate.
inline void DensityBlock::Draw(const double* uniforms, double* u) const noexcept {
  Row e{};
  Row z{};
  double c = 0.0;
  for (int i = 0; i < dim; ++i) {
    const auto ii = static_cast<std::size_t>(i);
    e[ii] = center[ii] + scale[ii] * marginal[ii]->Draw(uniforms[i]);
    if (i == 0) c = Clamped(e[0]);
    if (bent && i > 0) {
      if (tapered && Tapers(i)) e[ii] *= std::exp(LogThickness(i, c));
      z[ii] = e[ii] + BendAt(i, c, e.data());
    } else {
      z[ii] = e[ii];
    }
  }
  for (int i = 0; i < dim; ++i) {
    const auto& row = unwhiten[static_cast<std::size_t>(i)];
    double sum = mean[static_cast<std::size_t>(i)];
    for (int j = 0; j < dim; ++j) sum += row[static_cast<std::size_t>(j)] * z[static_cast<std::size_t>(j)];
    u[i] = sum;
  }
}

}  // namespace armcmc
