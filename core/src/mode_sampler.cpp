#include "armcmc/mode_sampler.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "armcmc/density_fit.hpp"
#include "armcmc/sample_size.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr double kStudentDof = 5.0;        // tails of the Laplace components
constexpr double kLaplaceInflation = 1.2;  // their standard deviations
constexpr double kInitialShare = 0.10;     // of P_0 in the data-driven part of q
constexpr double kLaplaceShare = 0.15;     // of the Laplace fits there, once the pilot's fit exists
constexpr double kPilotEss = 250.0;        // effective draws of a pilot round that suffice
constexpr double kRefitShare = 0.4;        // effective share of the draws below which the proposal is fitted once more
constexpr double kMinimumGroup = 2e-3;     // posterior probability below which a group of draws gets no block
constexpr FitOptions kPilotFit{.bandwidth_factor = 1.2, .tail_weight = 0.15, .tail_sd = 1.8, .inflation = 1.1};
constexpr FitOptions kMemoryFit{.bandwidth_factor = 0.7, .tail_weight = 0.02, .tail_sd = 1.25};
constexpr double kNoiseMemory = 0.1;  // standard deviation of log s that a posterior hands on at least
constexpr double kInformedSd = 0.9;   // of the prior's: a posterior narrower than that in any parameter says something

constexpr int RoundUp(int n) noexcept { return (n + kTileLanes - 1) / kTileLanes * kTileLanes; }

/// Kish effective sample size of weight[first, last).
double WeightEss(const std::vector<double>& weight, int first, int last) noexcept {
  double sum = 0.0;
  double square = 0.0;
  for (int k = first; k < last; ++k) {
    const double w = weight[static_cast<std::size_t>(k)];
    sum += w;
    square += w * w;
  }
  return square > 0.0 ? sum * sum / square : 0.0;
}

enum Purpose : std::uint64_t {
  kMismatchStream = 0,
  kDrawStream = 1,
  kAcceptStream = 2,
  kNoiseStream = 3,
  kNumPurposes = 4
};

}  // namespace

SamplerWorkspace::SamplerWorkspace(int dim, int capacity) {
  const auto cap = static_cast<std::size_t>(std::max(RoundUp(capacity), Proposal::kMaxBatch) + kTileLanes);
  for (auto* v : {&log_likelihood, &proposal, &initial_prior, &likelihood, &weight, &group_weight, &first_share,
                  &noise_coordinate})
    v->resize(cap);
  for (auto& m : memory) m.resize(cap);
  component.resize(cap);
  straight[kMaxParams].resize(cap);
  straight[kMaxParams + 1].resize(cap);
  for (int d = 0; d < dim; ++d) {
    straight[static_cast<std::size_t>(d)].resize(cap);
    mismatch_u[static_cast<std::size_t>(d)].resize(ModeSampler::kMismatchDraws + kTileLanes);
  }
}

std::array<double*, kMaxParams + 2> SamplerWorkspace::StraightRows() noexcept {
  std::array<double*, kMaxParams + 2> rows{};
  for (std::size_t d = 0; d < rows.size(); ++d) rows[d] = straight[d].data();
  return rows;
}

ModeSampler::ModeSampler(const simd::Kernels& kernels, int model, const SamplerSettings& sampler,
                         const ForgettingSettings& forgetting, const ParameterSpace& space, const NoiseModel& noise)
    : kernels_(kernels),
      model_(model),
      sampler_(sampler),
      forgetting_(forgetting),
      space_(space),
      noise_(noise),
      normal_table_(MarginalTable::Normal()),
      student_table_(MarginalTable::StudentT(kStudentDof)) {
  // P_0 as a proposal: axis aligned, each coordinate with its own law.
  std::array<const MarginalTable*, kMaxParams> laws{};
  for (int d = 0; d < space_.dim; ++d) {
    const auto i = static_cast<std::size_t>(d);
    uniform_tables_[i] = MarginalTable::Uniform(space_.upper[i]);
    laws[i] = space_.normal[i] > 0.0 ? &normal_table_ : &uniform_tables_[i];
  }
  SetAxisAligned(space_.dim, laws, &initial_block_);
}

Mismatch ModeSampler::Compare(const ModeData& data, const PosteriorMemory& previous, RandomStream stream,
                              SamplerWorkspace* ws) const noexcept {
  std::array<double*, kMaxParams> u{};
  for (int d = 0; d < space_.dim; ++d)
    u[static_cast<std::size_t>(d)] = ws->mismatch_u[static_cast<std::size_t>(d)].data();
  Proposal memory;
  for (int b = 0; b < previous.num_blocks; ++b)
    memory.Add(&previous.block[static_cast<std::size_t>(b)], previous.weight[static_cast<std::size_t>(b)]);
  memory.Normalise();
  memory.Draw(kernels_, stream, 0, kMismatchDraws, u.data(), ws->component.data(), ws->StraightRows().data());
  for (int k = 0; k < kMismatchDraws; ++k) {
    for (int d = 0; d < space_.dim; ++d) {
      const auto i = static_cast<std::size_t>(d);
      u[i][k] = std::clamp(u[i][k], space_.lower[i], space_.upper[i]);
    }
  }
  PredictiveMoments& p = ws->predictive;
  p.num_samples = data.num_samples;
  for (int n = 0; n < data.num_samples; ++n)
    p.mean[static_cast<std::size_t>(n)] = p.variance[static_cast<std::size_t>(n)] = 0.0;
  double mean_sum = 0.0;
  double mean_square = 0.0;
  alignas(64) std::array<double, kTileLanes> log_scale;
  for (int first = 0; first < kMismatchDraws; first += kTileLanes) {
    kernels_.to_physical(space_, u.data(), first, &ws->theta, log_scale.data());
    kernels_.predict(model_, data, ws->theta, &ws->prediction);
    std::array<double, kTileLanes> lane_mean{};
    for (int n = 0; n < data.num_samples; ++n) {
      const auto in = static_cast<std::size_t>(n);
      // Differences from the first draw keep the variance of a narrow posterior from cancelling.
      if (first == 0) p.mean[in] = ws->prediction.value[in][0];
      for (std::size_t l = 0; l < kTileLanes; ++l) lane_mean[l] += ws->prediction.value[in][l];
    }
    for (std::size_t l = 0; l < kTileLanes; ++l) {
      const double m = lane_mean[l] / data.num_samples;
      mean_sum += m;
      mean_square += m * m;
    }
    // Second sweep of the tile: running first and second moments about the reference in p.mean.
    for (int n = 0; n < data.num_samples; ++n) {
      const auto in = static_cast<std::size_t>(n);
      double s1 = 0.0;
      double s2 = 0.0;
      const double reference = p.mean[in];
      for (std::size_t l = 0; l < kTileLanes; ++l) {
        const double d = ws->prediction.value[in][l] - reference;
        s1 += d;
        s2 += d * d;
      }
      ws->group_weight[in] = (first == 0 ? 0.0 : ws->group_weight[in]) + s1;
      p.variance[in] += s2;
    }
  }
  for (int n = 0; n < data.num_samples; ++n) {
    const auto in = static_cast<std::size_t>(n);
    const double shift = ws->group_weight[in] / kMismatchDraws;
    p.mean[in] += shift;
    p.variance[in] = std::fmax(p.variance[in] / kMismatchDraws - shift * shift, 0.0);
  }
  mean_sum /= kMismatchDraws;
  p.variance_of_mean = std::fmax(mean_square / kMismatchDraws - mean_sum * mean_sum, 0.0);
  return EvaluateMismatch(forgetting_, noise_, std::exp(previous.log_noise_scale), data, p);
}

int ModeSampler::DrawTarget(const Mismatch& mismatch, ModeDraws* out) const noexcept {
  const double k_min = MinimumDraws(mismatch.lambda, sampler_.epsilon, sampler_.delta);
  out->k_min = static_cast<int>(std::ceil(std::fmin(k_min, kMaxDraws)));
  int target = 0;
  switch (sampler_.rule) {
    case DrawRule::kChernoff: target = ChernoffDraws(sampler_.epsilon, sampler_.delta); break;
    case DrawRule::kKMin: target = out->k_min; break;
    case DrawRule::kFixed: target = sampler_.fixed_draws; break;
  }
  return std::clamp(target, SamplerSettings::kMinDraws, sampler_.max_draws);
}

void ModeSampler::FitLaplace(const ModeData& data, const PosteriorMemory& previous, bool use_previous,
                             SamplerWorkspace* ws) noexcept {
  const int dim = space_.dim;
  const Gaussian initial{ParamVector::Zero(dim), ParamMatrix::Identity(dim, dim)};
  double best = LaplaceFit(kernels_, model_, data, noise_, space_, initial, initial.mean, &ws->laplace, &fit_fresh_);
  if (previous.valid) {
    Gaussian other;
    const double value =
        LaplaceFit(kernels_, model_, data, noise_, space_, initial, previous.mean, &ws->laplace, &other);
    if (value > best) fit_fresh_ = other;
  }
  SetElliptic(fit_fresh_.mean, fit_fresh_.precision.inverse(), kLaplaceInflation, &student_table_, &laplace_fresh_);
  if (!use_previous) return;
  const Gaussian prior{previous.mean, previous.covariance.inverse()};
  LaplaceFit(kernels_, model_, data, noise_, space_, prior, previous.mean, &ws->laplace, &fit_persisted_);
  SetElliptic(fit_persisted_.mean, fit_persisted_.precision.inverse(), kLaplaceInflation, &student_table_,
              &laplace_persisted_);
}

void ModeSampler::BuildProposal(const PosteriorMemory& previous, double lambda_q, bool use_previous,
                                int num_pilot_blocks, Proposal* proposal) const noexcept {
  proposal->Clear();
  if (use_previous)
    for (int b = 0; b < previous.num_blocks; ++b)
      proposal->Add(&previous.block[static_cast<std::size_t>(b)],
                    lambda_q * std::fmax(previous.weight[static_cast<std::size_t>(b)], 0.05));
  const double rest = use_previous ? 1.0 - lambda_q : 1.0;
  const double laplace = num_pilot_blocks > 0 ? kLaplaceShare : 1.0 - kInitialShare;
  for (int b = 0; b < num_pilot_blocks; ++b)
    proposal->Add(&pilot_blocks_[static_cast<std::size_t>(b)],
                  rest * (1.0 - kInitialShare - kLaplaceShare) / num_pilot_blocks);
  // The pilot's blocks stand in for the Laplace fit of what they were drawn for; after a modification, with P_0 alone
  // in the target, it stays, against a late surprise in the tails.
  if (use_previous && num_pilot_blocks == 0) {
    proposal->Add(&laplace_persisted_, 0.6 * rest * laplace);
    proposal->Add(&laplace_fresh_, 0.4 * rest * laplace);
  } else if (!use_previous) {
    proposal->Add(&laplace_fresh_, rest * laplace);
  }
  proposal->Add(&initial_block_, rest * kInitialShare);
  proposal->Normalise();
}

void ModeSampler::DrawAndScore(const Proposal& proposal, const PosteriorMemory& previous, const ModeData& data,
                               int first, int count, const RandomStream& stream, SamplerWorkspace* ws,
                               ModeDraws* out) const noexcept {
  const int last = first + count;
  const int end = first + RoundUp(count);
  double* const* u = out->u.data();
  const DensityBlock* const memory_begin = previous.block.data();
  const DensityBlock* const memory_end = memory_begin + previous.num_blocks;
  const auto is_memory = [&](const DensityBlock* b) noexcept { return b >= memory_begin && b < memory_end; };
  proposal.Draw(kernels_, stream, first, count, u, &ws->component[static_cast<std::size_t>(first)],
                ws->StraightRows().data());
  for (int k = last; k < end; ++k)  // lanes past the end repeat the last candidate; nothing reads their results
    for (int d = 0; d < out->dim; ++d) u[d][k] = u[d][last - 1];

  alignas(64) std::array<double, kTileLanes> log_scale;
  for (int k = first; k < end; k += kTileLanes) {
    const auto at = static_cast<std::size_t>(k);
    kernels_.to_physical(space_, u, k, &ws->theta, log_scale.data());
    kernels_.predict(model_, data, ws->theta, &ws->prediction);
    kernels_.log_likelihood(noise_, data, ws->prediction, log_scale.data(), &ws->log_likelihood[at]);
    kernels_.initial_prior(space_, u, k, &ws->initial_prior[at]);
    double* q = &ws->proposal[at];
    std::fill(q, q + kTileLanes, 0.0);
    for (int b = 0; b < previous.num_blocks; ++b) {
      double* m = &ws->memory[static_cast<std::size_t>(b)][at];
      std::fill(m, m + kTileLanes, 0.0);
      kernels_.add_density(previous.block[static_cast<std::size_t>(b)], u, k, 1.0, m);
    }
    for (int c = 0; c < proposal.size(); ++c) {
      const auto& component = proposal.component(c);
      if (is_memory(component.block)) {
        const double* m = &ws->memory[static_cast<std::size_t>(component.block - memory_begin)][at];
        for (int l = 0; l < kTileLanes; ++l) q[l] += component.share * m[l];
      } else {
        kernels_.add_density(*component.block, u, k, component.share, q);
      }
    }
  }
}

double ModeSampler::Weigh(const PosteriorMemory& previous, double lambda, int first, int last, SamplerWorkspace* ws,
                          const ModeDraws&) const noexcept {
  double reference = -HUGE_VAL;
  for (int k = first; k < last; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double value = ws->log_likelihood[i];
    if (ws->initial_prior[i] > 0.0 && value > reference && std::isfinite(value)) reference = value;
  }
  if (!std::isfinite(reference)) return std::nan("");
  // Whole vectors: first is a multiple of the lanes, and the arrays are padded past last.
  kernels_.relative_likelihood(&ws->log_likelihood[static_cast<std::size_t>(first)], reference, RoundUp(last - first),
                               &ws->likelihood[static_cast<std::size_t>(first)]);
  const bool use_previous = lambda > 0.0;
  const double w0 = use_previous ? lambda * previous.weight[0] / memory_inside_ : 0.0;
  const double w1 = use_previous && previous.num_blocks > 1 ? lambda * previous.weight[1] / memory_inside_ : 0.0;
  for (int k = first; k < last; ++k) {
    const auto i = static_cast<std::size_t>(k);
    double prior = (1.0 - lambda) * ws->initial_prior[i];
    if (use_previous) prior += w0 * ws->memory[0][i] + (w1 > 0.0 ? w1 * ws->memory[1][i] : 0.0);
    const double q = sampler_.use_proposal_ratio ? ws->proposal[i] : 1.0;
    const double w = ws->initial_prior[i] > 0.0 ? ws->likelihood[i] * prior / q : 0.0;
    ws->weight[i] = std::isfinite(w) ? w : 0.0;
  }
  return reference;
}

int ModeSampler::FitPilot(const PosteriorMemory& previous, double lambda, int first, int last, SamplerWorkspace* ws,
                          const ModeDraws& draws, double* ess) noexcept {
  const auto offset = static_cast<std::size_t>(first);
  WeightedDraws weighted{.dim = space_.dim, .size = last - first, .u = {}, .weight = ws->weight.data() + offset};
  for (int d = 0; d < space_.dim; ++d)
    weighted.u[static_cast<std::size_t>(d)] = draws.u[static_cast<std::size_t>(d)] + first;
  const auto fit = [&](const WeightedDraws& group, int block) noexcept {
    const auto b = static_cast<std::size_t>(block);
    return FitBlock(kernels_, group, kPilotFit, ws->StraightRows().data(), ws->pilot_tables[b].data(),
                    &pilot_blocks_[b]);
  };
  // Persisted and changed parameters get a block each where both have a say.
  if (lambda > 0.0) {
    double total = 0.0;
    double changed = 0.0;
    for (int k = first; k < last; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const double fresh = (1.0 - lambda) * ws->initial_prior[i];
      double persisted = previous.weight[0] * ws->memory[0][i];
      if (previous.num_blocks > 1) persisted += previous.weight[1] * ws->memory[1][i];
      const double share = fresh / (fresh + lambda * persisted / memory_inside_ + 1e-300);
      ws->group_weight[i] = ws->weight[i] * share;
      total += ws->weight[i];
      changed += ws->group_weight[i];
    }
    if (changed > 0.02 * total && changed < 0.98 * total) {
      WeightedDraws group = weighted;
      group.weight = ws->group_weight.data() + offset;
      *ess = fit(group, 0);
      int blocks = *ess >= kMinimumEss ? 1 : 0;
      for (int k = first; k < last; ++k) {
        const auto i = static_cast<std::size_t>(k);
        ws->group_weight[i] = ws->weight[i] - ws->group_weight[i];
      }
      const double other = fit(group, blocks);
      blocks += other >= kMinimumEss ? 1 : 0;
      *ess += other;
      return blocks;
    }
  }
  *ess = fit(weighted, 0);
  return *ess >= kMinimumEss ? 1 : 0;
}

bool ModeSampler::BuildRidgeProposal(const ModeData& data, const PosteriorMemory& previous, bool use_previous,
                                     double lambda_q, SamplerWorkspace* ws, Proposal* proposal) noexcept {
  const int dim = space_.dim;
  const Gaussian initial{ParamVector::Zero(dim), ParamMatrix::Identity(dim, dim)};
  const Gaussian persisted = use_previous ? Gaussian{previous.mean, previous.covariance.inverse()} : initial;
  const int anchors = FollowRidge(kernels_, model_, data, noise_, space_, persisted,
                                  use_previous ? fit_persisted_ : fit_fresh_, &ws->laplace, &anchors_);
  if (anchors == 0) return false;
  proposal->Clear();
  if (use_previous)
    for (int b = 0; b < previous.num_blocks; ++b)
      proposal->Add(&previous.block[static_cast<std::size_t>(b)],
                    0.5 * lambda_q * previous.weight[static_cast<std::size_t>(b)] + 1e-3);
  for (int k = 0; k < anchors; ++k) {
    const auto i = static_cast<std::size_t>(k);
    SetElliptic(anchors_[i].mean, anchors_[i].covariance, kLaplaceInflation, &normal_table_, &ridge_blocks_[i]);
    proposal->Add(&ridge_blocks_[i], anchors_[i].share);
  }
  proposal->Add(&laplace_fresh_, kInitialShare);
  proposal->Add(&initial_block_, kInitialShare);
  proposal->Normalise();
  return true;
}

void ModeSampler::FindMode(const ModeData& data, SamplerWorkspace* ws, ModeDraws* out) const noexcept {
  ParamVector best(space_.dim);
  for (int d = 0; d < space_.dim; ++d) best[d] = out->u[static_cast<std::size_t>(d)][out->mode_index];
  if (out->decision == Decision::kModification) {
    // The target is likelihood x P_0, which is what the Laplace fit climbs; a uniform prior is flat inside its bounds.
    Gaussian prior{ParamVector::Zero(space_.dim), ParamMatrix::Zero(space_.dim, space_.dim)};
    for (int d = 0; d < space_.dim; ++d)
      prior.precision(d, d) = std::fmax(space_.normal[static_cast<std::size_t>(d)], 1e-9);
    Gaussian fit;
    LaplaceFit(kernels_, model_, data, noise_, space_, prior, best, &ws->laplace, &fit);
    if (fit.mean.allFinite()) best = fit.mean;
  }
  for (int d = 0; d < space_.dim; ++d) out->mode_u[static_cast<std::size_t>(d)] = best[d];
}

void ModeSampler::RunChain(const RandomStream& stream, SamplerWorkspace* ws, ModeDraws* out) const noexcept {
  const int draws = out->draws;
  std::fill(out->visits, out->visits + draws, 0);
  double* gamma = ws->group_weight.data();  // free between the fits
  kernels_.uniforms(stream.origin(), 0, 1, RoundUp(draws), gamma);
  int state = 0;
  double state_weight = ws->weight[0];
  int accepted = 0;
  for (int k = 0; k < draws; ++k) {
    const double w = ws->weight[static_cast<std::size_t>(k)];
    // gamma <= w / w_state without a division; a state of weight zero accepts everything.
    const bool accept = gamma[k] * state_weight <= w && (w > 0.0 || state_weight <= 0.0);
    state = accept ? k : state;
    state_weight = accept ? w : state_weight;
    out->chain[k] = state;
    if (k >= out->burn_in) {
      ++out->visits[state];
      accepted += accept ? 1 : 0;
    }
  }
  out->acceptance = static_cast<double>(accepted) / (draws - out->burn_in);
}

const double* ModeSampler::SpreadNoiseScale(int first, const RandomStream& stream, SamplerWorkspace* ws,
                                            const ModeDraws& draws) const noexcept {
  const auto d = static_cast<std::size_t>(space_.dim - 1);
  const double* u = draws.u[d];
  double mean = 0.0;
  double square = 0.0;
  for (int k = first; k < draws.draws; ++k) {
    mean += draws.weight[k] * u[k];
    square += draws.weight[k] * u[k] * u[k];
  }
  const double variance = std::fmax(square - mean * mean, 0.0);
  const double wanted = kNoiseMemory / space_.scale[d];
  const double jitter = std::sqrt(std::fmax(wanted * wanted - variance, 0.0));
  const int end = first + RoundUp(draws.draws - first);
  double* row = ws->noise_coordinate.data();
  kernels_.uniforms(stream.origin(), 0, 1, end - first, row + first);
  for (int k = first; k < end; ++k)
    row[k] = std::clamp(u[k] + jitter * normal_table_.Draw(row[k]), space_.lower[d], space_.upper[d]);
  return row;
}

void ModeSampler::Compress(const PosteriorMemory& previous, double lambda, int first, const RandomStream& stream,
                           SamplerWorkspace* ws, PosteriorMemory* next, ModeDraws* out) noexcept {
  const int count = out->draws - first;
  const auto offset = static_cast<std::size_t>(first);
  WeightedDraws group{.dim = space_.dim, .size = count, .u = {}, .weight = ws->group_weight.data() + offset};
  for (int d = 0; d < space_.dim; ++d)
    group.u[static_cast<std::size_t>(d)] = out->u[static_cast<std::size_t>(d)] + first;
  // The level of the noise is carried on loosely. Held as tightly as thousands of samples allow, a quieter or louder
  // stretch could only be explained by everything having changed, and the parameters would be forgotten with it.
  if (space_.samples_noise_scale())
    group.u[static_cast<std::size_t>(space_.dim - 1)] = SpreadNoiseScale(first, stream, ws, *out) + first;

  // Where a draw's prior came from: the first block of the memory, the second, or drawn anew.
  const bool use_previous = lambda > 0.0;
  const double w0 = use_previous ? lambda * previous.weight[0] / memory_inside_ : 0.0;
  const double w1 = use_previous && previous.num_blocks > 1 ? lambda * previous.weight[1] / memory_inside_ : 0.0;
  double mass_first = 0.0;
  double mass_new = 0.0;
  if (use_previous) {
    for (int k = first; k < out->draws; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const double a = w0 * ws->memory[0][i];
      const double b = w1 > 0.0 ? w1 * ws->memory[1][i] : 0.0;
      const double c = (1.0 - lambda) * ws->initial_prior[i];
      const double total = a + b + c + 1e-300;
      ws->first_share[i] = a / total;
      mass_first += out->weight[k] * a / total;
      mass_new += out->weight[k] * c / total;
    }
  }
  out->p_changed = use_previous ? std::clamp(mass_new, 0.0, 1.0) : 1.0;

  next->num_blocks = 0;
  for (int k = out->draws; k < first + RoundUp(count); ++k) ws->group_weight[static_cast<std::size_t>(k)] = 0.0;
  // A group's weights are (constant + slope x share of the first block) of the draws' weights.
  const auto fit_group = [&](double mass, double constant, double slope) noexcept {
    if (mass < kMinimumGroup) return;
    for (int k = first; k < out->draws; ++k) {
      const auto i = static_cast<std::size_t>(k);
      ws->group_weight[i] = out->weight[k] * (slope == 0.0 ? constant : constant + slope * ws->first_share[i]);
    }
    const auto b = static_cast<std::size_t>(next->num_blocks);
    const double ess =
        FitBlock(kernels_, group, kMemoryFit, ws->StraightRows().data(), next->tables[b].data(), &next->block[b]);
    if (ess < kMinimumEss) return;
    next->weight[b] = mass;
    ++next->num_blocks;
  };
  if (!use_previous) {
    fit_group(1.0, 1.0, 0.0);
  } else if (mass_first >= 0.5) {
    fit_group(mass_first, 0.0, 1.0);
    fit_group(1.0 - mass_first, 1.0, -1.0);
  } else {
    fit_group(1.0 - mass_first, 1.0, -1.0);
    fit_group(mass_first, 0.0, 1.0);
  }
  if (next->num_blocks == 0) {
    // Too few effective draws for moments: the Laplace fit, widened, is the safer summary.
    const Gaussian& fit = use_previous ? fit_persisted_ : fit_fresh_;
    SetElliptic(fit.mean, fit.precision.inverse(), 1.5, &normal_table_, &next->block[0]);
    next->num_blocks = 1;
    next->weight[0] = 1.0;
  }
  double total = 0.0;
  for (int b = 0; b < next->num_blocks; ++b) total += next->weight[static_cast<std::size_t>(b)];
  for (int b = 0; b < next->num_blocks; ++b) next->weight[static_cast<std::size_t>(b)] /= total;
  next->mean = MeanOf(next->block[0]);
  next->covariance = CovarianceOf(next->block[0]);
  next->valid = true;
  next->informed = previous.valid && previous.informed;
  for (int d = 0; d < space_.num_parameters; ++d)
    next->informed = next->informed ||
                     std::sqrt(next->covariance(d, d)) < kInformedSd * space_.prior_sd[static_cast<std::size_t>(d)];
}

Status ModeSampler::Run(const ModeData& data, const PosteriorMemory& previous, std::uint64_t pack, std::uint64_t mode,
                        Nanos deadline_ns, ClockRef clock, int limit, SamplerWorkspace* ws, PosteriorMemory* next,
                        ModeDraws* out) noexcept {
  const auto stream_of = [&](Purpose purpose) noexcept {
    return RandomStream(sampler_.seed, pack, mode * kNumPurposes + purpose);
  };
  Mismatch mismatch;
  mismatch.zeta = HUGE_VAL;  // zeta^0: the first pack is a modification
  mismatch.threshold = forgetting_.threshold;
  if (previous.valid) mismatch = Compare(data, previous, stream_of(kMismatchStream), ws);
  const bool use_previous = mismatch.decision == Decision::kReinforcement;
  const double lambda = mismatch.lambda;
  const int wanted = DrawTarget(mismatch, out);
  const int target = std::clamp(limit, SamplerSettings::kMinDraws, wanted);
  const double lambda_q = std::clamp(lambda, sampler_.lambda_q_min, sampler_.lambda_q_max);

  FitLaplace(data, previous, use_previous, ws);
  Proposal proposal;
  BuildProposal(previous, lambda_q, use_previous, 0, &proposal);
  const RandomStream stream = stream_of(kDrawStream);
  // Pilot rounds: Laplace fits, then, where they are a poor match, the ridge, then what the ridge round learnt.
  const int pilot_size = std::min(kPilotDraws, wanted / (2 * kMaxPilotRounds) / kTileLanes * kTileLanes);
  memory_inside_ = 1.0;
  int pilot = 0;
  int pilot_blocks = 0;
  for (int round = 0; round < kMaxPilotRounds; ++round) {
    const int first = pilot;
    pilot += pilot_size;
    DrawAndScore(proposal, previous, data, first, pilot_size, stream, ws, out);
    double ess = 0.0;
    if (!std::isnan(Weigh(previous, lambda, first, pilot, ws, *out)))
      pilot_blocks = FitPilot(previous, lambda, first, pilot, ws, *out, &ess);
    if (ess >= kPilotEss) break;
    const bool ridge = round == 0 && BuildRidgeProposal(data, previous, use_previous, lambda_q, ws, &proposal);
    if (!ridge) BuildProposal(previous, lambda_q, use_previous, pilot_blocks, &proposal);
  }
  BuildProposal(previous, lambda_q, use_previous, pilot_blocks, &proposal);

  // Nothing above or below depends on `limit` but where the loop ends, so that a truncated run repeats to the bit.
  int made = pilot;
  bool refitted = false;
  Nanos worst_chunk_ns = 0;
  while (made < target || made == pilot) {  // at most max_draws / kChunkDraws + 2 turns
    const int chunk = std::min(kChunkDraws, (made < target ? target : wanted) - made);
    const Nanos before = clock.Now();
    const auto finish = static_cast<Nanos>(finish_ns_per_draw_ * (made + chunk));
    if (made > pilot && before + worst_chunk_ns + finish > deadline_ns) break;
    DrawAndScore(proposal, previous, data, made, chunk, stream, ws, out);
    made += chunk;
    worst_chunk_ns = std::max(worst_chunk_ns, clock.Now() - before);
    // One late correction, still inside the half of the chain that is thrown away: what was drawn so far is a better
    // guide than the pilot where that was a poor match.
    if (!refitted && made >= wanted / 4 && made + kChunkDraws <= wanted) {
      refitted = true;
      double ess = 0.0;
      if (std::isnan(Weigh(previous, lambda, pilot, made, ws, *out))) continue;
      if (WeightEss(ws->weight, pilot, made) > kRefitShare * (made - pilot)) continue;
      const int blocks = FitPilot(previous, lambda, pilot, made, ws, *out, &ess);
      if (blocks == 0) continue;
      BuildProposal(previous, lambda_q, use_previous, blocks, &proposal);
      pilot = made;
    }
  }
  const Nanos finish_start = clock.Now();
  out->draws = made;
  out->burn_in = std::max(made / 2, pilot);
  out->truncated = made < wanted;

  const int memory_components = use_previous ? previous.num_blocks : 0;
  int memory_draws = 0;
  int memory_inside = 0;
  for (int k = 0; k < made; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const bool from_memory = ws->component[i] < memory_components;  // they are the proposal's first components
    memory_draws += from_memory ? 1 : 0;
    memory_inside += from_memory && ws->initial_prior[i] > 0.0 ? 1 : 0;
  }
  memory_inside_ = memory_draws > 0 ? std::fmax(memory_inside, 1.0) / memory_draws : 1.0;
  const double reference = Weigh(previous, lambda, 0, made, ws, *out);
  if (std::isnan(reference)) return Status::kNonFinite;

  double sum = 0.0;
  double square = 0.0;
  double best = -1.0;
  for (int k = 0; k < made; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double w = ws->weight[i];
    if (k >= pilot) {
      sum += w;
      square += w * w;
    }
    const double density = sampler_.use_proposal_ratio ? w * ws->proposal[i] : w;
    if (density > best) {
      best = density;
      out->mode_index = k;
    }
  }
  if (!(sum > 0.0)) return Status::kNonFinite;
  for (int k = 0; k < made; ++k) out->weight[k] = k < pilot ? 0.0 : ws->weight[static_cast<std::size_t>(k)] / sum;
  out->kish_ess = sum * sum / square;
  out->log_evidence = reference + std::log(sum / (made - pilot));
  out->decision = mismatch.decision;
  out->zeta = mismatch.zeta;
  out->zeta_threshold = mismatch.threshold;
  out->lambda = lambda;
  out->num_samples = data.num_samples;
  FindMode(data, ws, out);
  RunChain(stream_of(kAcceptStream), ws, out);
  Compress(previous, lambda, pilot, stream_of(kNoiseStream), ws, next, out);
  double log_scale = space_.log_noise_scale;
  if (space_.samples_noise_scale()) {
    const auto d = static_cast<std::size_t>(space_.dim - 1);
    double mean = 0.0;
    for (int k = 0; k < made; ++k) mean += out->weight[k] * out->u[d][k];
    log_scale = space_.Theta(space_.dim - 1, mean);
  }
  next->log_noise_scale = log_scale;
  out->known = next->informed;
  out->updated = true;
  const double spent = static_cast<double>(clock.Now() - finish_start) / made;
  finish_ns_per_draw_ = std::fmax(0.9 * finish_ns_per_draw_, spent);
  return out->truncated ? Status::kTruncated : Status::kOk;
}

}  // namespace armcmc
