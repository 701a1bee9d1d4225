// The Laplace fits of ModeSampler, and where they start.

#include "armcmc/mode_sampler.hpp"

#include <cmath>

#include "armcmc/density_fit.hpp"
#include "armcmc/linear_algebra.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr double kBetterMode = 0.1;  // nats by which another mode must be better, to exclude the same mode found again
constexpr int kScattered = 256;      // draws from P_0 in the search for starting points
constexpr int kScatteredStarts = 3;  // fits started from the best of them
constexpr double kScatteredApart = 0.25;  // squared distance of two starts, standard deviations of the prior
constexpr double kNoiseSurprise = 4.0;    // squared distance of the noise scale from before, relative to its variance
static_assert(kScattered <= ModeSampler::kMismatchDraws);  // whose rows they use

}  // namespace

void ModeSampler::FitFromScattered(const ModeData& data, const RandomStream& stream, SamplerWorkspace* ws, double best,
                                   Gaussian* fit) const noexcept {
  const int dim = space_.dim;
  std::array<double*, kMaxParams> u{};
  for (int d = 0; d < dim; ++d) u[static_cast<std::size_t>(d)] = ws->mismatch_u[static_cast<std::size_t>(d)].data();
  Proposal scattered;
  scattered.Add(&initial_block_, 1.0);
  scattered.Normalise();
  scattered.Draw(kernels_, stream, 0, kScattered, u.data(), ws->component.data(), ws->StraightRows().data());
  double* const value = ws->group_weight.data();
  alignas(64) std::array<double, kTileLanes> log_scale;
  for (int k = 0; k < kScattered; k += kTileLanes) {
    kernels_.to_physical(space_, u.data(), k, ws->theta.data(), log_scale.data());
    kernels_.score(model_, noise_, data, ws->theta[0], log_scale.data(), &ws->prediction, value + k);
  }
  const Gaussian initial{ParamVector::Zero(dim), ParamMatrix::Identity(dim, dim)};
  const auto quality = [](double log_posterior, const Gaussian& of) noexcept {
    return log_posterior - 0.5 * std::log(Determinant(of.precision));
  };
  double leading = quality(best, *fit);
  for (int start = 0; start < kScatteredStarts; ++start) {
    int chosen = -1;
    for (int k = 0; k < kScattered; ++k)
      if (std::isfinite(value[k]) && (chosen < 0 || value[k] > value[chosen])) chosen = k;
    if (chosen < 0) return;
    ParamVector from(dim);
    for (int d = 0; d < dim; ++d) from[d] = u[static_cast<std::size_t>(d)][chosen];
    Gaussian other;
    const double log_posterior =
        LaplaceFit(kernels_, model_, data, noise_, space_, initial, from, kModeTolerance, &ws->laplace, &other);
    const double other_quality = quality(log_posterior, other);
    if (other.mean.allFinite() && other_quality > leading + kBetterMode) {
      leading = other_quality;
      *fit = other;
    }
    // The next from a different point.
    for (int k = 0; k < kScattered; ++k) {
      double apart = 0.0;
      for (int d = 0; d < dim; ++d) {
        const double difference = u[static_cast<std::size_t>(d)][k] - from[d];
        apart += difference * difference;
      }
      if (apart < kScatteredApart) value[k] = std::nan("");
    }
  }
}

void ModeSampler::FitLaplace(const ModeData& data, const PosteriorMemory& previous, bool use_previous,
                             const RandomStream& stream, SamplerWorkspace* ws) noexcept {
  const int dim = space_.dim;
  laplace_fits_ = 1;
  const Gaussian initial{ParamVector::Zero(dim), ParamMatrix::Identity(dim, dim)};
  const auto fit_from = [&](const ParamVector& start, Gaussian* fit) noexcept ARMCMC_NONBLOCKING {
    return LaplaceFit(kernels_, model_, data, noise_, space_, initial, start, kModeTolerance, &ws->laplace, fit);
  };
  // Data that agree with the previous posterior have their mode near its mean.
  if (use_previous && !transition_.Offers(previous)) {
    (void)fit_from(previous.mean, &fit_fresh_);
  } else {
    double best = fit_from(initial.mean, &fit_fresh_);
    Gaussian other;
    if (previous.valid) {
      ++laplace_fits_;
      const double from_previous = fit_from(previous.mean, &other);
      if (from_previous > best + kBetterMode) {
        fit_fresh_ = other;
        best = from_previous;
      }
    }
    FitFromScattered(data, stream, ws, best, &fit_fresh_);
    laplace_fits_ += kScatteredStarts;
  }
  SetElliptic(fit_fresh_.mean, Inverse(fit_fresh_.precision), kLaplaceInflation, &student_table_, &laplace_fresh_);
  num_persisted_ = 0;
  if (!use_previous) return;
  const auto add = [&](const Gaussian& fit) noexcept ARMCMC_NONBLOCKING {
    SetElliptic(fit.mean, Inverse(fit.precision), kLaplaceInflation, &student_table_,
                &laplace_persisted_[static_cast<std::size_t>(num_persisted_++)]);
  };
  if (transition_.Offers(previous)) {
    fit_persisted_ = transition_.fit(0);
    for (int b = 0; b < previous.num_blocks; ++b) add(transition_.fit(b));
    return;
  }
  FitUnder(previous.mean, previous.covariance, data, ws, &fit_persisted_);
  add(fit_persisted_);
}

void ModeSampler::FitUnder(const ParamVector& mean, const ParamMatrix& covariance, const ModeData& data,
                           SamplerWorkspace* ws, Gaussian* fit) noexcept {
  Gaussian prior{mean, Inverse(covariance)};
  ++laplace_fits_;
  (void)LaplaceFit(kernels_, model_, data, noise_, space_, prior, mean, kModeTolerance, &ws->laplace, fit);
  if (!space_.samples_noise_scale()) return;
  // For the noise scale the memory has the tails of a t law, which do not constrain distant values.
  const Eigen::Index last = space_.dim - 1;
  const double away = (fit->mean[last] - mean[last]) * (fit->mean[last] - mean[last]) / covariance(last, last);
  if (!(away > kNoiseSurprise)) return;
  const double hold = std::sqrt((kStudentDof + 1.0) / (kStudentDof - 2.0 + away));
  prior.precision.row(last) *= hold;
  prior.precision.col(last) *= hold;
  const ParamVector start = fit->mean;
  (void)LaplaceFit(kernels_, model_, data, noise_, space_, prior, start, kModeTolerance, &ws->laplace, fit);
}

void ModeSampler::FitConstantAndDrifting(const ModeData& data, const PosteriorMemory& previous,
                                         SamplerWorkspace* ws) noexcept {
  num_persisted_ = 0;
  for (int b = 0; b < previous.num_blocks; ++b) {
    const DensityBlock& block = previous.block[static_cast<std::size_t>(b)];
    Gaussian fit;
    FitUnder(MeanOf(block), CovarianceOf(block), data, ws, &fit);
    SetElliptic(fit.mean, Inverse(fit.precision), kLaplaceInflation, &student_table_,
                &laplace_persisted_[static_cast<std::size_t>(num_persisted_++)]);
  }
}

ParamVector ModeSampler::ModeFromPrior(const ModeData& data, SamplerWorkspace* ws) const noexcept {
  const int dim = space_.dim;
  const Gaussian initial{ParamVector::Zero(dim), ParamMatrix::Identity(dim, dim)};
  Gaussian fit;
  (void)LaplaceFit(kernels_, model_, data, noise_, space_, initial, initial.mean, kModeTolerance, &ws->laplace, &fit);
  return fit.mean;
}

}  // namespace armcmc
