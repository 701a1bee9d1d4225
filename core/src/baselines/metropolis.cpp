#include "armcmc/baselines/metropolis.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/rng.hpp"
#include "armcmc/sample_size.hpp"
#include "simd/kernels.hpp"

namespace armcmc {

// A baseline for comparison, not part of the product: Eigen's products and factorisations are used as in text books.
// All types are bounded; the allocation tests and RealtimeSanitizer cover all of it.
ARMCMC_TRUST_NONBLOCKING_BEGIN

MetropolisFilter::MetropolisFilter(const FilterParts& parts) : parts_(parts), normal_table_(MarginalTable::Normal()) {}

int MetropolisFilter::Wanted() const noexcept {
  const SamplerSettings& s = parts_.settings.sampler;
  const int draws = s.rule == DrawRule::kFixed ? s.fixed_draws : ChernoffDraws(s.epsilon, s.delta);
  return std::clamp(draws, SamplerSettings::kMinDraws, s.max_draws);
}

double MetropolisFilter::LogTarget(const ModeData& data, const ParamVector& u) noexcept {
  alignas(64) std::array<double, kTileLanes> log_scale, prior, log_likelihood;
  std::array<const double*, kMaxParams> rows{};
  for (int d = 0; d < parts_.space.dim; ++d) {
    const auto i = static_cast<std::size_t>(d);
    lanes_[i].fill(u[d]);
    rows[i] = lanes_[i].data();
  }
  parts_.kernels.initial_prior(parts_.space, rows.data(), 0, prior.data());
  if (!(prior[0] > 0.0)) return -HUGE_VAL;
  parts_.kernels.to_physical(parts_.space, rows.data(), 0, &scratch_.theta, log_scale.data());
  parts_.kernels.score(parts_.model, parts_.noise, data, scratch_.theta, log_scale.data(), &scratch_.prediction,
                       log_likelihood.data());
  const double value = log_likelihood[0] + std::log(prior[0]);
  return std::isfinite(value) ? value : -HUGE_VAL;
}

Status MetropolisFilter::Run(const ModeData& data, std::uint64_t pack, std::uint64_t mode, Nanos deadline_ns,
                             ClockRef clock, int limit, ModeDraws* out) noexcept {
  const int dim = parts_.space.dim;
  const int wanted = Wanted();
  const int target = std::clamp(limit, SamplerSettings::kMinDraws, wanted);
  const int burn_in = wanted / 2;
  const Gaussian prior{ParamVector::Zero(dim), ParamMatrix::Identity(dim, dim)};
  Gaussian fit;
  (void)LaplaceFit(parts_.kernels, parts_.model, data, parts_.noise, parts_.space, prior, prior.mean, kModeTolerance,
                   &scratch_, &fit);
  ParamVector state = fit.mean;
  for (int d = 0; d < dim; ++d) {
    const auto i = static_cast<std::size_t>(d);
    state[d] = std::clamp(state[d], parts_.space.lower[i] + 1e-9, parts_.space.upper[i] - 1e-9);
  }
  const ParamMatrix covariance = Inverse(fit.precision);
  ParamMatrix root;
  if (!CholeskyFactor(covariance, &root)) root = 0.1 * ParamMatrix::Identity(dim, dim);
  double value = LogTarget(data, state);
  if (!std::isfinite(value)) return Status::kNonFinite;

  RandomStream stream(parts_.settings.sampler.seed, pack, mode);
  double log_scale = std::log(2.38 / std::sqrt(static_cast<double>(dim)));
  ParamVector mean = ParamVector::Zero(dim);
  ParamMatrix scatter = ParamMatrix::Zero(dim, dim);
  ParamVector z(dim), trial(dim);
  int chain_state = 0, accepted = 0, made = 0;
  std::fill(out->visits, out->visits + wanted, 0);
  Nanos worst = 0;
  Nanos chunk_start = clock.Now();
  for (int k = 0; k < target; ++k) {
    if (k > 0 && k % kChunk == 0) {
      const Nanos now = clock.Now();
      worst = std::max(worst, now - chunk_start);
      chunk_start = now;
      if (now + worst > deadline_ns && k >= SamplerSettings::kMinDraws) break;
    }
    for (int d = 0; d < dim; ++d) z[d] = normal_table_.Draw(stream.Uniform());
    trial = state + std::exp(log_scale) * Multiply(root, z);
    const double trial_value = LogTarget(data, trial);
    const double ratio = std::exp(std::fmin(trial_value - value, 0.0));
    const bool accept = stream.Uniform() < ratio;
    if (accept) {
      state = trial;
      value = trial_value;
    }
    if (accept || k == 0) {
      for (int d = 0; d < dim; ++d) out->u[static_cast<std::size_t>(d)][k] = state[d];
      chain_state = k;
    } else {
      for (int d = 0; d < dim; ++d) out->u[static_cast<std::size_t>(d)][k] = trial[d];
    }
    out->chain[k] = chain_state;
    made = k + 1;
    if (k >= burn_in) {
      accepted += accept ? 1 : 0;
      continue;
    }
    log_scale += std::pow(k + 1.0, -0.6) * (ratio - kAcceptance);
    const ParamVector delta = state - mean;
    mean += delta / (k + 1.0);
    scatter += delta * (state - mean).transpose();
    if (k + 1 == burn_in / 2 || k + 1 == burn_in) {
      ParamMatrix c = scatter / k;
      c.diagonal() *= 1.0 + 1e-9;
      if (ParamMatrix l; CholeskyFactor(c, &l)) root = l;
      if (k + 1 < burn_in) log_scale = std::log(2.38 / std::sqrt(static_cast<double>(dim)));
    }
  }
  const int first = made > burn_in ? burn_in : made / 2;
  for (int k = first; k < made; ++k) ++out->visits[out->chain[k]];
  for (int k = 0; k < made; ++k) out->weight[k] = static_cast<double>(out->visits[k]) / (made - first);
  FillStep(data, made, first, out);
  out->truncated = made < wanted;
  out->acceptance = static_cast<double>(accepted) / std::max(made - first, 1);
  known_ = known_ || IsInformed(parts_.space, *out);
  out->known = known_;
  return out->truncated ? Status::kTruncated : Status::kOk;
}

ARMCMC_TRUST_NONBLOCKING_END

}  // namespace armcmc
