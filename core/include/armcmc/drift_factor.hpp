#pragma once

#include "armcmc/mode_data.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

/// What the likelihood of a pack gains when its parameters drift while it is recorded.
///
/// The scored candidate u is where the parameters stand at the end of the pack. At velocity w they were at u - w t when
/// a sample was taken t before that, and its error is e(u) + A w, A = t dF/du, both in units of the noise. With
/// w ~ N(m, C), m = m_0 + K (u - u_0), the likelihood of u without w is that of constant parameters times
///
///   exp(c' (C^-1 + G)^-1 c / 2 - m' (a + G m / 2)) / sqrt(det(1 + C G)),   a = A' e(u), G = A' A, c = a + G m
///
/// e(u) is exact for every candidate; A is taken at one place. T' T = C with T G T' = diag(l) gives the inverse for
/// every scale of the noise. Laws of the noise other than the Gaussian: e in `a` is the derivative of their log
/// density, and G has their Fisher information.
///
/// Plain numbers: read by the scoring kernels.
struct alignas(64) DriftFactor {
  using Square = double[kMaxParams][kMaxParams];

  int dim = 0;                                  ///< Parameters. 0: the factor is 1.
  double speed[kMaxParams], place[kMaxParams];  ///< m_0, u_0
  Square regression, information, whiten;       ///< K, G, T
  double gain[kMaxParams];                      ///< l
  double log_scale = 0.0;                       ///< Of the noise that G is in units of.
  double lever[kMaxParams][kMaxPackSamples];    ///< t dF/du_d times the weight of the sample.
};

/// `a` of kTileLanes candidates: value[parameter][lane].
struct alignas(64) LeverTile {
  double value[kMaxParams][kTileLanes];
};

}  // namespace armcmc
