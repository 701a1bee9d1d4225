#include "armcmc/ridge.hpp"

#include <algorithm>
#include <cmath>

namespace armcmc {
namespace {

constexpr int kFewestAnchors = 6;
constexpr double kRidgeReach = 4.5;   // standard deviations of the worst known coordinate
constexpr double kPinned = 1e12;      // precision that holds a coordinate
constexpr double kEvenShare = 0.2;    // share of the proposal that is spread evenly over the relevant anchors
constexpr double kNegligible = 14.0;  // nats below the best anchor

int LeastCertainParameter(const ParameterSpace& space, const ParamMatrix& covariance) noexcept {
  int worst = 0;
  for (int d = 1; d < space.num_parameters; ++d)
    if (covariance(d, d) > covariance(worst, worst)) worst = d;
  return worst;
}

/// Fills mean, covariance and log mass (in `share`) of the anchor that pins coordinate j at `value`.
bool FitAnchor(const simd::Kernels& kernels, int model, const ModeData& data, const NoiseModel& noise,
               const ParameterSpace& space, const Gaussian& prior, int j, double value, double step,
               const ParamVector& start, LaplaceScratch* scratch, RidgeAnchor* anchor) noexcept {
  Gaussian pinned = prior;
  ParamVector begin = start;
  begin[j] = value;
  // (u_j - value)^2 kPinned added to the prior's quadratic form.
  pinned.precision(j, j) += kPinned;
  pinned.mean = SymmetricFactor(pinned.precision)
                    .Solve(Multiply(prior.precision, prior.mean) + kPinned * value * ParamVector::Unit(space.dim, j));
  Gaussian fit;
  const double height =
      LaplaceFit(kernels, model, data, noise, space, pinned, begin, kProposalTolerance, scratch, &fit);
  ParamMatrix h = fit.precision;
  h(j, j) -= kPinned;
  // Conditional precision: the rows and columns other than j. Written with j's row replaced by a unit row.
  ParamMatrix rest = h;
  ParamVector coupling = h.col(j);
  coupling[j] = 0.0;
  rest.row(j).setZero();
  rest.col(j).setZero();
  rest(j, j) = 1.0;
  const SymmetricFactor factor(rest);
  const ParamVector slope = factor.Solve(coupling);
  h(j, j) = 1.0 / (step * step) + coupling.dot(slope);
  anchor->mean = fit.mean;
  anchor->covariance = Inverse(h);
  const double determinant = factor.Diagonal().prod();
  const ParamVector offset = fit.mean - prior.mean;
  const ParamVector pinned_offset = fit.mean - pinned.mean;
  // Height of the unpinned posterior: replace the pinned quadratic form by the prior's.
  anchor->share = height + 0.5 * pinned_offset.dot(Multiply(pinned.precision, pinned_offset)) -
                  0.5 * offset.dot(Multiply(prior.precision, offset)) - 0.5 * std::log(std::fmax(determinant, 1e-300));
  return anchor->mean.allFinite() && anchor->covariance.allFinite() && std::isfinite(anchor->share);
}

}  // namespace

int FollowRidge(const simd::Kernels& kernels, int model, const ModeData& data, const NoiseModel& noise,
                const ParameterSpace& space, const Gaussian& prior, const Gaussian& fit, int count,
                LaplaceScratch* scratch, std::array<RidgeAnchor, kRidgeAnchors>* anchors) noexcept {
  const ParamMatrix covariance = Inverse(fit.precision);
  const int j = LeastCertainParameter(space, covariance);
  const auto ij = static_cast<std::size_t>(j);
  const double sd = std::sqrt(std::fmax(covariance(j, j), 0.0));
  const double from = std::fmax(space.lower[ij], fit.mean[j] - kRidgeReach * sd);
  const double to = std::fmin(space.upper[ij], fit.mean[j] + kRidgeReach * sd);
  if (!(to > from)) return 0;
  count = std::clamp(count, kFewestAnchors, kRidgeAnchors);
  const double step = (to - from) / count;
  // Outward from the mode in both directions, each fit starting at the extrapolation of its two neighbours. For an even
  // number of anchors two are equally near to the mode: the choice must not depend on rounding.
  constexpr double kNearer = 1e-6;
  const int middle = std::clamp(static_cast<int>((fit.mean[j] - from) / step + kNearer), 0, count - 1);
  int written = 0;
  for (const int direction : {1, -1}) {
    ParamVector start = fit.mean;
    ParamVector heading = ParamVector::Zero(space.dim);
    const int first = direction > 0 ? middle : middle - 1;
    for (int k = first; k >= 0 && k < count; k += direction) {
      RidgeAnchor& anchor = (*anchors)[static_cast<std::size_t>(written)];
      if (!FitAnchor(kernels, model, data, noise, space, prior, j, from + (k + 0.5) * step, step, start + heading,
                     scratch, &anchor))
        break;
      if (k != first) heading = anchor.mean - start;
      start = anchor.mean;
      ++written;
    }
  }
  double top = -HUGE_VAL;
  for (int k = 0; k < written; ++k) top = std::fmax(top, (*anchors)[static_cast<std::size_t>(k)].share);
  double sum = 0.0;
  int kept = 0;
  for (int k = 0; k < written; ++k) {
    RidgeAnchor& anchor = (*anchors)[static_cast<std::size_t>(k)];
    if (anchor.share < top - kNegligible) continue;
    const double mass = std::exp(anchor.share - top);
    (*anchors)[static_cast<std::size_t>(kept)] = anchor;
    (*anchors)[static_cast<std::size_t>(kept++)].share = mass;
    sum += mass;
  }
  for (int k = 0; k < kept; ++k) {
    double& share = (*anchors)[static_cast<std::size_t>(k)].share;
    share = (1.0 - kEvenShare) * share / sum + kEvenShare / kept;
  }
  return kept;
}

}  // namespace armcmc
