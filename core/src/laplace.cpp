#include "armcmc/laplace.hpp"

#include <algorithm>
#include <cmath>

#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr std::array<double, 4> kDampings{0.0, 1e-2, 1.0, 100.0};
constexpr std::array<double, 8> kLengths{1.0, 0.5, 0.25, 0.1, 0.03, 0.01, 1.5, 0.0};
constexpr double kDifference = 1e-4;  // in prior standard deviations; error of central differences about 1e-8
constexpr double kConverged = 1e-6;   // nats that a Newton step promises

/// Writes one candidate into a lane of the batch.
void SetLane(const ParameterSpace& space, const ParamVector& u, int lane, ThetaTile* theta,
             double* log_scale) noexcept {
  const auto l = static_cast<std::size_t>(lane);
  for (int d = 0; d < space.num_parameters; ++d) theta->value[static_cast<std::size_t>(d)][l] = space.Theta(d, u[d]);
  log_scale[l] = space.LogNoiseScale(u.data());
}

void Clamp(const ParameterSpace& space, ParamVector* u) noexcept {
  for (int d = 0; d < space.dim; ++d)
    (*u)[d] = std::clamp((*u)[d], space.lower[static_cast<std::size_t>(d)], space.upper[static_cast<std::size_t>(d)]);
}

/// True when coordinate d lies on a bound and the posterior rises beyond it.
bool IsPressed(const ParameterSpace& space, const ParamVector& u, const ParamVector& gradient, int d) noexcept {
  const auto i = static_cast<std::size_t>(d);
  return (u[d] <= space.lower[i] && gradient[d] > 0.0) || (u[d] >= space.upper[i] && gradient[d] < 0.0);
}

/// The others move as if those that are pressed against their bounds stay there (projected Newton steps).
void HoldPressed(const ParameterSpace& space, const ParamVector& u, ParamVector* gradient,
                 ParamMatrix* hessian) noexcept {
  for (int d = 0; d < space.dim; ++d) {
    if (!IsPressed(space, u, *gradient, d)) continue;
    (*gradient)[d] = 0.0;
    hessian->row(d).setZero();
    hessian->col(d).setZero();
    (*hessian)(d, d) = 1.0;
  }
}

/// -(H + mu diag H)^-1 g, or none where that is not finite.
ParamVector DampedStep(const ParamMatrix& hessian, const ParamVector& gradient, double damping) noexcept {
  ParamMatrix damped = hessian;
  damped.diagonal() *= 1.0 + damping;
  ParamVector step = -SymmetricFactor(damped).Solve(gradient);
  if (!step.allFinite()) step.setZero();
  return step;
}

/// Of every candidate of a batch: a product of matrix and vector for each by itself would cost as much as the batch.
double LogPrior(const Gaussian& prior, const ParamVector& u) noexcept {
  const auto dim = u.size();
  double sum = 0.0;
  for (Eigen::Index i = 0; i < dim; ++i) {
    const double di = u[i] - prior.mean[i];
    double row = 0.5 * prior.precision(i, i) * di;
    for (Eigen::Index j = 0; j < i; ++j) row += prior.precision(i, j) * (u[j] - prior.mean[j]);
    sum += di * row;
  }
  return -sum;
}

/// Predictions at u, in lane 0, and a little to either side of it in each parameter d, in lanes 1 + 2 d and 2 + 2 d.
void PredictAround(const simd::Kernels& kernels, int model, const ModeData& data, const ParameterSpace& space,
                   const ParamVector& u, LaplaceScratch* scratch) noexcept {
  ThetaTile& theta = scratch->theta;
  for (std::size_t d = 0; d < static_cast<std::size_t>(space.num_parameters); ++d) {
    const auto value = [&](double shift) noexcept {
      return space.Theta(static_cast<int>(d), u[static_cast<Eigen::Index>(d)] + shift);
    };
    theta.value[d].fill(value(0.0));
    theta.value[d][1 + 2 * d] = value(kDifference);
    theta.value[d][2 + 2 * d] = value(-kDifference);
  }
  const bool half = 1 + 2 * space.num_parameters <= kTileLanes / 2;
  (half ? kernels.predict_half : kernels.predict)(model, data, theta, &scratch->prediction);
}

/// d F_n / d u_d, after PredictAround().
double Slope(const LaplaceScratch& scratch, std::size_t n, int d) noexcept {
  const auto& row = scratch.prediction.value[n];
  return (row[static_cast<std::size_t>(1 + 2 * d)] - row[static_cast<std::size_t>(2 + 2 * d)]) / (2.0 * kDifference);
}

/// Gradient and Gauss-Newton Hessian of minus the log posterior at u.
void Linearise(const simd::Kernels& kernels, int model, const ModeData& data, const NoiseModel& noise,
               const ParameterSpace& space, const Gaussian& prior, const ParamVector& u, LaplaceScratch* scratch,
               ParamVector* gradient, ParamMatrix* hessian) noexcept {
  const int dim = space.dim;
  const int np = space.num_parameters;
  PredictAround(kernels, model, data, space, u, scratch);

  *gradient = Multiply(prior.precision, u - prior.mean);
  *hessian = prior.precision;
  const double scale = std::exp(space.LogNoiseScale(u.data()));
  double scale_gradient = 0.0;
  std::array<double, kMaxParams> jacobian{};
  for (int n = 0; n < data.num_samples; ++n) {
    const auto in = static_cast<std::size_t>(n);
    const auto& row = scratch->prediction.value[in];
    const double w = data.weight[in];
    const double e = (data.target[in] - row[0] - noise.settings().mean) * w;
    const double square_weight = noise.SquareWeight(e, scale);
    for (int d = 0; d < np; ++d) jacobian[static_cast<std::size_t>(d)] = w * Slope(*scratch, in, d);
    for (int i = 0; i < np; ++i) {
      const double ji = square_weight * jacobian[static_cast<std::size_t>(i)];
      (*gradient)[i] -= ji * e;
      for (int j = 0; j <= i; ++j) (*hessian)(i, j) += ji * jacobian[static_cast<std::size_t>(j)];
    }
    scale_gradient += 1.0 - square_weight * e * e;
  }
  if (space.samples_noise_scale()) {
    const double s = space.scale[static_cast<std::size_t>(dim - 1)];
    (*gradient)[dim - 1] += s * scale_gradient;
    (*hessian)(dim - 1, dim - 1) += s * s * data.num_samples * noise.scale_information();
  }
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < i; ++j) (*hessian)(j, i) = (*hessian)(i, j);
}

}  // namespace

LocalLikelihood ExpandLikelihood(const simd::Kernels& kernels, int model, const ModeData& data, const NoiseModel& noise,
                                 const ParameterSpace& space, const ParamVector& u, double log_noise_scale,
                                 LaplaceScratch* scratch) noexcept {
  const int np = space.num_parameters;
  PredictAround(kernels, model, data, space, u, scratch);
  LocalLikelihood local{ParamVector::Zero(np), ParamMatrix::Zero(np, np)};
  const double scale = std::exp(log_noise_scale);
  const double information = noise.information() / (scale * scale);
  ParamVector slope(np);
  for (int n = 0; n < data.num_samples; ++n) {
    const auto in = static_cast<std::size_t>(n);
    const double w = data.weight[in];
    const double e = (data.target[in] - scratch->prediction.value[in][0] - noise.settings().mean) * w;
    const double score = noise.SquareWeight(e, scale) * e;
    for (int d = 0; d < np; ++d) slope[d] = w * Slope(*scratch, in, d);
    for (int i = 0; i < np; ++i) {
      local.gradient[i] += slope[i] * score;
      for (int j = 0; j <= i; ++j) local.information(i, j) += information * slope[i] * slope[j];
    }
  }
  for (int i = 0; i < np; ++i)
    for (int j = 0; j < i; ++j) local.information(j, i) = local.information(i, j);
  return local;
}

double LaplaceFit(const simd::Kernels& kernels, int model, const ModeData& data, const NoiseModel& noise,
                  const ParameterSpace& space, const Gaussian& prior, const ParamVector& start, LaplaceScratch* scratch,
                  Gaussian* fit) noexcept {
  const int dim = space.dim;
  alignas(64) double log_scale[kTileLanes];
  alignas(64) double log_likelihood[kTileLanes];
  std::array<ParamVector, kTileLanes> trial;
  ParamVector u = start;
  Clamp(space, &u);
  ParamVector gradient(dim);
  ParamMatrix hessian(dim, dim);
  double best = -HUGE_VAL;
  bool linearised = false;  // at u, or so close to it that it makes no difference
  for (int iteration = 0; iteration < kLaplaceIterations; ++iteration) {
    Linearise(kernels, model, data, noise, space, prior, u, scratch, &gradient, &hessian);
    ParamVector free_gradient = gradient;
    ParamMatrix free_hessian = hessian;
    HoldPressed(space, u, &free_gradient, &free_hessian);
    const ParamVector newton = DampedStep(free_hessian, free_gradient, 0.0);
    const double promised = -0.5 * free_gradient.dot(newton);
    linearised = iteration > 0 && promised < kConverged;
    if (linearised) {
      best += std::fmax(promised, 0.0);
      u += newton;
      Clamp(space, &u);
      break;
    }
    int lane = 0;
    for (const double damping : kDampings) {
      const ParamVector step = damping > 0.0 ? DampedStep(free_hessian, free_gradient, damping) : newton;
      for (const double length : kLengths) {
        ParamVector& candidate = trial[static_cast<std::size_t>(lane)];
        candidate = u + length * step;
        Clamp(space, &candidate);
        SetLane(space, candidate, lane, &scratch->theta, log_scale);
        ++lane;
      }
    }
    kernels.score(model, noise, data, scratch->theta, log_scale, &scratch->prediction, log_likelihood);
    int chosen = -1;
    double chosen_value = best;
    for (int l = 0; l < kTileLanes; ++l) {
      const double value = log_likelihood[l] + LogPrior(prior, trial[static_cast<std::size_t>(l)]);
      if (value > chosen_value) {
        chosen_value = value;
        chosen = l;
      }
    }
    if (chosen < 0) break;
    const bool converged = chosen_value - best < 1e-6 * (1.0 + std::fabs(chosen_value));
    best = chosen_value;
    u = trial[static_cast<std::size_t>(chosen)];
    if (converged) break;
  }
  if (!linearised) Linearise(kernels, model, data, noise, space, prior, u, scratch, &gradient, &hessian);
  // Pressed against a bound with slope g the posterior falls off like exp(-g x), with standard deviation 1 / g.
  for (int d = 0; d < dim; ++d)
    if (IsPressed(space, u, gradient, d)) hessian(d, d) += gradient[d] * gradient[d];
  fit->mean = u;
  fit->precision = hessian;
  return best;
}

}  // namespace armcmc
