// The proposal of ModeSampler: Laplace fits, pilot, ridge, and the scoring of what is drawn.

#include "armcmc/mode_sampler.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/density_fit.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr double kLaplaceInflation = 1.2;  // standard deviations of the Laplace components
constexpr double kInitialShare = 0.10;     // of P_0 in the data-driven part of q
constexpr double kLaplaceShare = 0.15;     // of the Laplace fits there, once the pilot's fit exists
constexpr FitOptions kPilotFit{.bandwidth_factor = 1.2, .tail_weight = 0.15, .tail_sd = 1.8, .inflation = 1.1};

}  // namespace

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
  SetElliptic(fit_fresh_.mean, Evaluate(fit_fresh_.precision.inverse()), kLaplaceInflation, &student_table_,
              &laplace_fresh_);
  if (!use_previous) return;
  const Gaussian prior{previous.mean, Evaluate(previous.covariance.inverse())};
  LaplaceFit(kernels_, model_, data, noise_, space_, prior, previous.mean, &ws->laplace, &fit_persisted_);
  SetElliptic(fit_persisted_.mean, Evaluate(fit_persisted_.precision.inverse()), kLaplaceInflation, &student_table_,
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

bool ModeSampler::BuildRidgeProposal(const ModeData& data, const PosteriorMemory& previous, bool use_previous,
                                     double lambda_q, SamplerWorkspace* ws, Proposal* proposal) noexcept {
  const int dim = space_.dim;
  const Gaussian initial{ParamVector::Zero(dim), ParamMatrix::Identity(dim, dim)};
  const Gaussian persisted = use_previous ? Gaussian{previous.mean, Evaluate(previous.covariance.inverse())} : initial;
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

void ModeSampler::DrawAndScore(const Proposal& proposal, const PosteriorMemory& previous, const ModeData& data,
                               int first, int count, const RandomStream& stream, SamplerWorkspace* ws,
                               ModeDraws* out) const noexcept {
  const int last = first + count;
  const int end = first + RoundUpToTile(count);
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
    kernels_.score(model_, noise_, data, ws->theta, log_scale.data(), &ws->prediction, &ws->log_likelihood[at]);
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

}  // namespace armcmc
