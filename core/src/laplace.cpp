#include "armcmc/laplace.hpp"

#include <algorithm>
#include <cmath>

#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr std::array<double, 4> kDampings{0.0, 1e-2, 1.0, 100.0};
/// A trial step: index of the damping, and factor of the step length.
struct Trial {
  std::size_t damping;
  double length;
};
/// In addition to the Newton step, as many as fit into the lanes that its linearisation does not use.
constexpr std::array<Trial, 15> kTrials{{{0, 1.5},
                                         {2, 1.5},
                                         {0, 0.5},
                                         {2, 0.5},
                                         {0, 0.25},
                                         {3, 0.25},
                                         {0, 0.1},
                                         {1, 1.0},
                                         {3, 1.0},
                                         {2, 0.1},
                                         {2, 1.0},
                                         {3, 0.1},
                                         {1, 1.5},
                                         {0, 0.03},
                                         {3, 0.03}}};
/// All dampings, if none of the above improves the posterior.
constexpr std::array<double, 8> kLengths{0.7, 0.35, 0.15, 0.06, 0.03, 0.01, 0.003, 0.001};
constexpr double kDifference = 1e-4;  // in prior standard deviations; error of central differences about 1e-8
constexpr double kGoodEnough = 0.8;   // share of the best gain above which the step that is already linearised is taken

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

/// The other coordinates move as if those pressed against their bounds were fixed (projected Newton steps).
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

/// -(H + mu diag H)^-1 g, or zero if that is not finite.
ParamVector DampedStep(const ParamMatrix& hessian, const ParamVector& gradient, double damping) noexcept {
  ParamMatrix damped = hessian;
  damped.diagonal() *= 1.0 + damping;
  ParamVector step = -SymmetricFactor(damped).Solve(gradient);
  if (!step.allFinite()) step.setZero();
  return step;
}

/// For all candidates of a batch: separate matrix-vector products would cost as much as the whole batch.
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

/// u in every lane, shifted to either side in parameter d in lanes 1 + 2 d and 2 + 2 d.
void SetAround(const ParameterSpace& space, const ParamVector& u, ThetaTile* theta) noexcept {
  for (std::size_t d = 0; d < static_cast<std::size_t>(space.num_parameters); ++d) {
    const auto value = [&](double shift) noexcept {
      return space.Theta(static_cast<int>(d), u[static_cast<Eigen::Index>(d)] + shift);
    };
    theta->value[d].fill(value(0.0));
    theta->value[d][1 + 2 * d] = value(kDifference);
    theta->value[d][2 + 2 * d] = value(-kDifference);
  }
}

/// Number of predicted lanes, of which the first 1 + 2 num_parameters are those of SetAround().
int LanesAround(const ParameterSpace& space) noexcept {
  return 1 + 2 * space.num_parameters <= kTileLanes / 2 ? kTileLanes / 2 : kTileLanes;
}

void PredictAround(const simd::Kernels& kernels, int model, const ModeData& data, const ParameterSpace& space,
                   LaplaceScratch* scratch) noexcept {
  const bool half = LanesAround(space) < kTileLanes;
  (half ? kernels.predict_half : kernels.predict)(model, data, scratch->theta, &scratch->prediction);
}

/// d F_n / d u_d, after PredictAround().
double Slope(const LaplaceScratch& scratch, std::size_t n, int d) noexcept {
  const auto& row = scratch.prediction.value[n];
  return (row[static_cast<std::size_t>(1 + 2 * d)] - row[static_cast<std::size_t>(2 + 2 * d)]) / (2.0 * kDifference);
}

/// Gradient and Gauss-Newton Hessian of minus the log posterior at u, after PredictAround().
void Linearise(const ModeData& data, const NoiseModel& noise, const ParameterSpace& space, const Gaussian& prior,
               const ParamVector& u, const LaplaceScratch& scratch, ParamVector* gradient,
               ParamMatrix* hessian) noexcept {
  const int dim = space.dim;
  const int np = space.num_parameters;
  *gradient = Multiply(prior.precision, u - prior.mean);
  *hessian = prior.precision;
  const double scale = std::exp(space.LogNoiseScale(u.data()));
  double scale_gradient = 0.0;
  std::array<double, kMaxParams> jacobian{};
  for (int n = 0; n < data.num_samples; ++n) {
    const auto in = static_cast<std::size_t>(n);
    const auto& row = scratch.prediction.value[in];
    const double w = data.weight[in];
    const double e = (data.target[in] - row[0] - noise.settings().mean) * w;
    const double square_weight = noise.SquareWeight(e, scale);
    for (int d = 0; d < np; ++d) jacobian[static_cast<std::size_t>(d)] = w * Slope(scratch, in, d);
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
  SetAround(space, u, &scratch->theta);
  PredictAround(kernels, model, data, space, scratch);
  LocalLikelihood local{ParamVector::Zero(np), ParamMatrix::Zero(np, np), ParamVector::Zero(np),
                        ParamMatrix::Zero(np, np), ParamMatrix::Zero(np, np)};
  const double scale = std::exp(log_noise_scale);
  const double information = noise.information() / (scale * scale);
  ParamVector slope(np);
  for (int n = 0; n < data.num_samples; ++n) {
    const auto in = static_cast<std::size_t>(n);
    const double w = data.weight[in];
    const double e = (data.target[in] - scratch->prediction.value[in][0] - noise.settings().mean) * w;
    const double score = noise.SquareWeight(e, scale) * e;
    const double lag = data.TimeToEnd(n);
    for (int d = 0; d < np; ++d) slope[d] = w * Slope(*scratch, in, d);
    for (int i = 0; i < np; ++i) {
      local.gradient[i] += slope[i] * score;
      local.lagged_gradient[i] += lag * slope[i] * score;
      for (int j = 0; j <= i; ++j) {
        const double of_sample = information * slope[i] * slope[j];
        local.information(i, j) += of_sample;
        local.lagged_information(i, j) += lag * of_sample;
        local.twice_lagged_information(i, j) += lag * lag * of_sample;
      }
    }
  }
  for (ParamMatrix* m : {&local.information, &local.lagged_information, &local.twice_lagged_information})
    for (int i = 0; i < np; ++i)
      for (int j = 0; j < i; ++j) (*m)(j, i) = (*m)(i, j);
  return local;
}

double LaplaceFit(const simd::Kernels& kernels, int model, const ModeData& data, const NoiseModel& noise,
                  const ParameterSpace& space, const Gaussian& prior, const ParamVector& start, double tolerance,
                  LaplaceScratch* scratch, Gaussian* fit) noexcept {
  const int dim = space.dim;
  const int around = 1 + 2 * space.num_parameters;
  const int lanes = LanesAround(space);
  alignas(64) double log_scale[kTileLanes];
  alignas(64) double log_likelihood[kTileLanes];
  std::array<ParamVector, kTileLanes> trial;
  ParamVector gradient(dim);
  ParamMatrix hessian(dim, dim);
  ParamVector u = start;
  Clamp(space, &u);
  const auto predict_around = [&](const ParamVector& v) noexcept ARMCMC_NONBLOCKING {
    SetAround(space, v, &scratch->theta);
    PredictAround(kernels, model, data, space, scratch);
  };
  const auto value_of = [&](int lane) noexcept {
    return log_likelihood[lane] + LogPrior(prior, trial[static_cast<std::size_t>(lane)]);
  };

  predict_around(u);
  trial[0] = u;
  std::fill_n(log_scale, kTileLanes, space.LogNoiseScale(u.data()));
  kernels.log_likelihood(noise, data, scratch->prediction, log_scale, log_likelihood);
  double best = value_of(0);
  if (!std::isfinite(best)) best = -HUGE_VAL;
  bool ends = false;  // at u
  for (int iteration = 0; iteration <= kLaplaceIterations; ++iteration) {
    Linearise(data, noise, space, prior, u, *scratch, &gradient, &hessian);
    if (ends || iteration == kLaplaceIterations) break;
    ParamVector free_gradient = gradient;
    ParamMatrix free_hessian = hessian;
    HoldPressed(space, u, &free_gradient, &free_hessian);
    const ParamVector newton = DampedStep(free_hessian, free_gradient, 0.0);
    const double promised = -0.5 * free_gradient.dot(newton);
    if (promised < tolerance) {
      best += std::fmax(promised, 0.0);
      u += newton;
      Clamp(space, &u);
      break;
    }
    std::array<ParamVector, kDampings.size()> damped;
    damped[0] = newton;
    for (std::size_t k = 1; k < kDampings.size(); ++k)
      damped[k] = DampedStep(free_hessian, free_gradient, kDampings[k]);
    const auto set_trial = [&](std::size_t damping, double length, int lane) noexcept {
      ParamVector& candidate = trial[static_cast<std::size_t>(lane)];
      candidate = u + length * damped[damping];
      Clamp(space, &candidate);
      SetLane(space, candidate, lane, &scratch->theta, log_scale);
    };
    int chosen = -1;
    double chosen_value = best;
    const auto choose = [&](int lane) noexcept {
      const double value = value_of(lane);
      if (!(value > chosen_value)) return;
      chosen_value = value;
      chosen = lane;
    };

    // The Newton step with everything that a linearisation there needs, and other trial steps.
    trial[0] = u + newton;
    Clamp(space, &trial[0]);
    SetAround(space, trial[0], &scratch->theta);
    std::fill_n(log_scale, kTileLanes, space.LogNoiseScale(trial[0].data()));
    for (int lane = around; lane < lanes; ++lane) {
      const Trial& other = kTrials[static_cast<std::size_t>(lane - around)];
      set_trial(other.damping, other.length, lane);
    }
    PredictAround(kernels, model, data, space, scratch);
    kernels.log_likelihood(noise, data, scratch->prediction, log_scale, log_likelihood);
    for (int lane = around; lane < lanes; ++lane) choose(lane);
    const double full = value_of(0);
    const bool newton_does = full > best && !(full - best < kGoodEnough * (chosen_value - best));
    if (newton_does) {
      chosen = 0;
      chosen_value = full;
    } else if (chosen < 0) {
      int lane = 0;
      for (std::size_t k = 0; k < kDampings.size(); ++k)
        for (const double length : kLengths) set_trial(k, length, lane++);
      kernels.score(model, noise, data, scratch->theta, log_scale, &scratch->prediction, log_likelihood);
      for (lane = 0; lane < kTileLanes; ++lane) choose(lane);
      if (chosen < 0) break;
    }
    ends = chosen_value - best < std::fmax(tolerance, 1e-6 * (1.0 + std::fabs(chosen_value)));
    best = chosen_value;
    u = trial[static_cast<std::size_t>(chosen)];
    if (!newton_does) predict_around(u);
  }
  // Pressed against a bound with slope g the posterior falls off like exp(-g x), with standard deviation 1 / g.
  for (int d = 0; d < dim; ++d)
    if (IsPressed(space, u, gradient, d)) hessian(d, d) += gradient[d] * gradient[d];
  fit->mean = u;
  fit->precision = hessian;
  return best;
}

}  // namespace armcmc
