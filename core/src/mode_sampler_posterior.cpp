// The posterior of ModeSampler: weights, chain, and the prior of the next pack.

#include "armcmc/mode_sampler.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "armcmc/control_variates.hpp"
#include "armcmc/density_fit.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr double kMinimumGroup = 2e-3;  // posterior probability below which a group of draws gets no block
constexpr double kLesserPart = 0.2;     // posterior probability above which a group is always kept
constexpr int kMostRoots = 8;           // largest root of the weights for a group with too few effective draws
constexpr double kNoiseMemory = 0.1;    // minimum standard deviation of log s in the prior of the next pack
constexpr double kInformedSd = 0.9;     // relative to the prior: a posterior narrower in any parameter is informed
constexpr FitOptions kMemoryFit{
    .bandwidth_factor = 0.7, .tail_weight = 0.02, .tail_sd = 1.25, .shrink_to_normal = true};

}  // namespace

simd::PriorTerms ModeSampler::Prior(const PosteriorMemory& previous, double lambda, int first,
                                    const SamplerWorkspace& ws) const noexcept {
  const auto i = static_cast<std::size_t>(first);
  simd::PriorTerms prior;
  prior.initial = &ws.initial_prior[i];
  prior.initial_share = 1.0 - lambda;
  for (std::size_t b = 0; b < PosteriorMemory::kMaxBlocks; ++b) {
    prior.memory[b] = &ws.memory[b][i];
    if (lambda > 0.0 && static_cast<int>(b) < previous.num_blocks)
      prior.memory_share[b] = lambda * previous.weight[b] / memory_inside_;
  }
  return prior;
}

double ModeSampler::Weigh(const PosteriorMemory& previous, double lambda, int first, int last,
                          SamplerWorkspace* ws) const noexcept {
  // Whole vectors: first is a multiple of the lanes, and the lanes past last repeat a candidate.
  const auto i = static_cast<std::size_t>(first);
  const int count = RoundUpToTile(last - first);
  const double* log_likelihood = &ws->log_likelihood[i];
  const double reference = kernels_.largest_inside(log_likelihood, &ws->initial_prior[i], count);
  if (!std::isfinite(reference)) return std::nan("");
  double* weight = &ws->weight[i];
  kernels_.relative_likelihood(log_likelihood, reference, count, weight);
  kernels_.weigh(Prior(previous, lambda, first, *ws), sampler_.use_proposal_ratio ? &ws->proposal[i] : nullptr, count,
                 weight);
  std::fill_n(weight + (last - first), kTileLanes, 0.0);
  return reference;
}

void ModeSampler::FindMode(const ModeData& data, bool climb, SamplerWorkspace* ws, ModeDraws* out) const noexcept {
  ParamVector best(space_.dim);
  for (int d = 0; d < space_.dim; ++d) best[d] = out->u[static_cast<std::size_t>(d)][out->mode_index];
  if (climb) {
    // The target is likelihood x P_0, which is what the Laplace fit climbs; a uniform prior is flat inside its bounds.
    Gaussian prior{ParamVector::Zero(space_.dim), ParamMatrix::Zero(space_.dim, space_.dim)};
    for (int d = 0; d < space_.dim; ++d)
      prior.precision(d, d) = std::fmax(space_.normal[static_cast<std::size_t>(d)], 1e-9);
    Gaussian fit;
    LaplaceFit(kernels_, model_, data, noise_, space_, prior, best, kModeTolerance, &ws->laplace, &fit);
    if (fit.mean.allFinite()) best = fit.mean;
  }
  for (int d = 0; d < space_.dim; ++d) out->mode_u[static_cast<std::size_t>(d)] = best[d];
}

bool ModeSampler::ReduceSamplingError(int first, int last, bool use_previous, SamplerWorkspace* ws,
                                      ModeDraws* out) const noexcept {
  const auto offset = static_cast<std::size_t>(first);
  ProposalDraws draws{.size = last - first, .u = {}, .proposal = &ws->proposal[offset], .weight = out->weight + first};
  for (int d = 0; d < space_.dim; ++d)
    draws.u[static_cast<std::size_t>(d)] = out->u[static_cast<std::size_t>(d)] + first;
  return ReduceVariance(kernels_, use_previous ? fit_persisted_ : fit_fresh_, &normal_table_, draws,
                        {&ws->group_weight[offset], &ws->first_share[offset]});  // both free until Compress
}

void ModeSampler::RunChain(const RandomStream& stream, int first, SamplerWorkspace* ws, ModeDraws* out) const noexcept {
  const int draws = out->draws;
  std::fill(out->visits, out->visits + draws, 0);
  // gamma <= w / w_state, that is w_state <= w / gamma. A state of weight zero accepts everything, and no other
  // accepts a weight of zero. Non-negative numbers are ordered as their bits, whose comparison is faster.
  double* const bound = ws->group_weight.data();  // free between the fits
  const double* const weight = ws->weight.data();
  kernels_.uniforms(stream.origin(), 0, 1, RoundUpToTile(draws), bound);
  kernels_.ratio(weight, bound, RoundUpToTile(draws), bound);
  // A pilot draw with a very large weight, from a poorly matched proposal, would trap the chain.
  for (int k = 0; k < first; ++k) out->chain[k] = k;
  int state = first;
  auto state_weight = std::bit_cast<std::int64_t>(weight[first]);
  const auto step = [&](int k) noexcept {
    const bool accept = state_weight <= std::bit_cast<std::int64_t>(bound[k]);
    state = accept ? k : state;
    state_weight = accept ? std::bit_cast<std::int64_t>(weight[k]) : state_weight;
    out->chain[k] = state;
    return accept ? 1 : 0;
  };
  for (int k = first; k < out->burn_in; ++k) (void)step(k);
  int accepted = 0;
  for (int k = out->burn_in; k < draws; ++k) {
    accepted += step(k);
    ++out->visits[state];
  }
  out->acceptance = static_cast<double>(accepted) / (draws - out->burn_in);
}

void ModeSampler::AppendNoiseScale(int first, int count, const double* weight, MarginalTable* table,
                                   const ModeDraws& draws, DensityBlock* block) const noexcept {
  const auto d = static_cast<std::size_t>(space_.dim - 1);
  const double* const row = draws.u[d] + first;
  std::array<double, 3> sums{};
  kernels_.first_moments(1, &row, weight, count, sums.data());
  const double mean = sums[2] / sums[0];
  double square = 0.0;
  kernels_.second_moments(1, &row, weight, &mean, count, &square);
  const double sd = std::fmax(std::sqrt(square / sums[0]), kNoiseMemory / space_.scale[d]);
  AppendIndependent(mean, sd, student_table_, table, block);
}

void ModeSampler::SplitMassByPrior(SamplerWorkspace* ws, ModeDraws* out) noexcept {
  // The first block of the memory, the second, one of an earlier change, or a new draw from P_0.
  Unfinished& u = unfinished_;
  const bool split = drift_.Splits(*u.previous);
  double mass_first = 0.0;
  u.part = drift_.CarriedPart();
  if (u.lambda > 0.0) {
    const auto offset = static_cast<std::size_t>(u.first);
    const int count = RoundUpToTile(out->draws - u.first);
    const auto share = [&](const simd::PriorTerms& prior) noexcept ARMCMC_NONBLOCKING {
      std::array<double, 2> masses{};
      kernels_.share_prior(prior, out->weight + u.first, count, ws->first_share.data() + offset, masses.data());
      return masses;
    };
    simd::PriorTerms prior = Prior(*u.previous, u.lambda, u.first, *ws);
    std::array<double, 2> masses = share(prior);
    u.mass_new = masses[1];
    if (u.previous->num_blocks == 3) {
      double* const row = &ws->memory[2][offset];  // read for the last time
      for (int k = 0; k < count; ++k) row[k] = prior.initial_share * prior.initial[k] + prior.memory_share[2] * row[k];
      prior.initial = row;
      prior.initial_share = 1.0;
      prior.memory_share[2] = 0.0;
      masses = share(prior);
    }
    u.mass_first = mass_first = masses[0];
    u.mass_changed = masses[1];
    if (split && u.mass_changed >= kMinimumGroup) {
      // Three parts, of which two can be stored: what changed, and the rest as one.
      std::swap(prior.initial, prior.memory[0]);
      std::swap(prior.initial_share, prior.memory_share[0]);
      u.mass_first = share(prior)[0];
      u.part = Drift::Part::kWhole;
      u.first_changed = u.apart = true;
    } else if (split) {
      const bool first = mass_first >= 0.5;
      u.part = first == (drift_.drifting_block() == 0) ? Drift::Part::kDrift : Drift::Part::kRest;
      u.split = true;
    } else {
      u.apart = 1.0 - mass_first >= kMinimumGroup;
    }
  }
  out->p_changed = out->decision == Decision::kModification ? 1.0 : std::clamp(u.mass_new, 0.0, 1.0);
  const double kept = 1.0 - std::fmax(out->p_changed, std::clamp(u.mass_changed, 0.0, 1.0));
  const double drifted = drift_.drifting_block() == 0 ? mass_first : kept - mass_first;
  out->p_drifted = split ? std::clamp(drifted, 0.0, kept) : kept * drift_.share();
  out->drift_rate = drift_.rate();
}

Drift::Draws ModeSampler::DrawsForDrift(SamplerWorkspace* ws, const ModeDraws& draws) const noexcept {
  const Unfinished& u = unfinished_;
  const auto offset = static_cast<std::size_t>(u.first);
  Drift::Draws view{.count = RoundUpToTile(draws.draws - u.first),
                    .u = {},
                    .weight = draws.weight + u.first,
                    .log_likelihood = &ws->log_likelihood[offset],
                    .share = u.lambda > 0.0 ? &ws->first_share[offset] : nullptr,
                    .part = u.part,
                    .of_part = !u.first_changed,
                    .apart = u.apart,
                    .scratch = &ws->group_weight[offset]};
  if (drift_.Splits(*u.previous) && !u.first_changed)
    view.part = drift_.drifting_block() == 0 ? Drift::Part::kDrift : Drift::Part::kRest;
  for (int d = 0; d < space_.num_parameters; ++d)
    view.u[static_cast<std::size_t>(d)] = draws.u[static_cast<std::size_t>(d)] + u.first;
  return view;
}

void ModeSampler::FindEndOfPack(const ModeData& data, SamplerWorkspace* ws, ModeDraws* out) noexcept {
  const int first = unfinished_.first;
  const int count = RoundUpToTile(out->draws - first);
  const int dim = space_.num_parameters;
  std::array<const double*, kMaxParams> rows{};
  for (int d = 0; d < space_.dim; ++d) rows[static_cast<std::size_t>(d)] = out->u[static_cast<std::size_t>(d)] + first;
  const double* weight = out->weight + first;
  std::array<double, 2 + kMaxParams> sums{};
  const auto mean_of = [&](const double* w) noexcept ARMCMC_NONBLOCKING {
    kernels_.first_moments(space_.dim, rows.data(), w, count, sums.data());
    ParamVector mean(dim);
    for (int d = 0; d < dim; ++d) mean[d] = sums[2 + static_cast<std::size_t>(d)] / sums[0];
    return mean;
  };
  const auto end_of_changed = [&](const double* w, std::array<EndOfPack, kMaxParams>* end) noexcept ARMCMC_NONBLOCKING {
    const ParamVector mean = mean_of(w);
    if (sums[0] * sums[0] < kMinimumEss * sums[1]) return false;  // of no spread that could be widened
    std::array<double, kMaxParams*(kMaxParams + 1) / 2> second{};
    kernels_.second_moments(dim, rows.data(), w, mean.data(), count, second.data());
    ParamMatrix covariance(dim, dim);
    for (int i = 0, k = 0; i < dim; ++i)
      for (int j = 0; j <= i; ++j, ++k)
        covariance(i, j) = covariance(j, i) = second[static_cast<std::size_t>(k)] / sums[0];
    return drift_.FindEndOfChanged(mean, covariance, end);
  };
  out->some_changed = false;
  if (out->decision == Decision::kModification) {
    out->moves = end_of_changed(weight, &out->end);
    return;
  }
  const ParamVector mean = mean_of(weight);
  double log_noise_scale = space_.log_noise_scale;
  if (space_.samples_noise_scale())
    log_noise_scale = space_.Theta(dim, sums[2 + static_cast<std::size_t>(dim)] / sums[0]);
  const double kept = 1.0 - std::clamp(unfinished_.mass_changed, 0.0, 1.0);
  double p_drifted = kept > 0.0 ? out->p_drifted / kept : 0.0;
  const Drift::Draws draws = DrawsForDrift(ws, *out);
  if (!draws.apart) drift_.AddChanged(1.0 - unfinished_.lambda);
  out->moves = drift_.FindEnd(data, mean, log_noise_scale, draws, &p_drifted, &ws->laplace, &out->end);
  out->p_drifted = kept * p_drifted;
  if (!out->moves || !draws.apart) return;
  std::fill_n(out->changed, first, 0.0);
  double* const changed = out->changed + first;
  for (int k = 0; k < count; ++k) {
    changed[k] = 1.0 - draws.InBank(k);
    draws.scratch[k] = weight[k] * changed[k];
  }
  out->some_changed = end_of_changed(draws.scratch, &out->end_of_changed);
}

void ModeSampler::Compress(SamplerWorkspace* ws, PosteriorMemory* next, ModeDraws* out) noexcept {
  const bool use_previous = unfinished_.lambda > 0.0;
  const int first = unfinished_.first;
  const int count = out->draws - first;
  const auto offset = static_cast<std::size_t>(first);
  // The noise level is passed on with an inflated variance. With the precision of thousands of samples, a change of the
  // noise could only be explained by a change of all parameters, which would then be forgotten.
  WeightedDraws group{.dim = space_.num_parameters, .size = count, .u = {}, .weight = ws->group_weight.data() + offset};
  for (int d = 0; d < group.dim; ++d)
    group.u[static_cast<std::size_t>(d)] = out->u[static_cast<std::size_t>(d)] + first;

  FitOptions options = kMemoryFit;
  const double mass_first = unfinished_.mass_first;
  next->num_blocks = 0;
  for (int k = out->draws; k < first + RoundUpToTile(count); ++k) ws->group_weight[static_cast<std::size_t>(k)] = 0.0;
  // A group's weights are (constant + slope x share of the first block) of the draws' weights.
  const auto fit_group = [&](double mass, double constant, double slope) noexcept {
    if (mass < kMinimumGroup) return false;
    const double* share = ws->first_share.data();
    double* group_weight = ws->group_weight.data();
    if (slope == 0.0) {
      for (int k = first; k < out->draws; ++k) group_weight[k] = out->weight[k] * constant;
    } else {
      for (int k = first; k < out->draws; ++k) group_weight[k] = out->weight[k] * (constant + slope * share[k]);
    }
    options.mean_freedom = unfinished_.calibrated ? 1.0 - mass : 1.0;  // a part of the draws is calibrated in part
    const auto b = static_cast<std::size_t>(next->num_blocks);
    const auto fit = [&]() noexcept {
      return FitBlock(kernels_, group, options, ws->StraightRows().data(), next->tables[b].data(), &next->block[b]);
    };
    bool fitted = fit() >= kMinimumEss;
    // Too few effective draws of a group that must be kept: its posterior to a power below one, times the
    // proposal, is broad enough to be fitted by them. It has part of the information of the pack, and no other.
    for (int root = 0; root < kMostRoots && !fitted && mass >= kLesserPart; ++root) {
      for (int k = first; k < out->draws; ++k) group_weight[k] = std::sqrt(std::fmax(group_weight[k], 0.0));
      fitted = fit() >= 2.0 * kMinimumEss;
    }
    if (!fitted) return false;
    if (space_.samples_noise_scale())
      AppendNoiseScale(first, count, group.weight, &next->tables[b][static_cast<std::size_t>(group.dim)], *out,
                       &next->block[b]);
    next->weight[b] = mass;
    ++next->num_blocks;
    return true;
  };
  if (!use_previous) {
    (void)fit_group(1.0, 1.0, 0.0);
  } else {
    for (const bool of_first : {mass_first >= 0.5, mass_first < 0.5}) {
      const double mass = of_first ? mass_first : 1.0 - mass_first;
      // The less probable of rest and drift need not be drawn: Drift knows its position relative to the other.
      if (unfinished_.split && mass < kLesserPart) continue;
      const bool fitted = of_first ? fit_group(mass, 0.0, 1.0) : fit_group(mass, 1.0, -1.0);
      if (unfinished_.split && !fitted) break;  // the less probable one alone would replace the more probable
    }
  }
  if (next->num_blocks == 0) {
    // Too few effective draws for moments: the Laplace fit, widened, is the more robust summary.
    const Gaussian& fit = use_previous ? fit_persisted_ : fit_fresh_;
    SetElliptic(fit.mean, Inverse(fit.precision), 1.5, &normal_table_, &next->block[0]);
    next->num_blocks = 1;
    next->weight[0] = 1.0;
  }
  double total = 0.0;
  for (int b = 0; b < next->num_blocks; ++b) total += next->weight[static_cast<std::size_t>(b)];
  for (int b = 0; b < next->num_blocks; ++b) next->weight[static_cast<std::size_t>(b)] /= total;
  next->mean = MeanOf(next->block[0]);
  next->covariance = CovarianceOf(next->block[0]);
  next->valid = true;
  const PosteriorMemory& previous = *unfinished_.previous;
  next->informed = previous.valid && previous.informed;
  for (int d = 0; d < space_.num_parameters; ++d)
    next->informed = next->informed ||
                     std::sqrt(next->covariance(d, d)) < kInformedSd * space_.prior_sd[static_cast<std::size_t>(d)];
}

}  // namespace armcmc
