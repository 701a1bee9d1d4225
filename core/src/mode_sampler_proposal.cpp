// The proposal of ModeSampler: pilot, ridge, and the scoring of the draws.

#include "armcmc/mode_sampler.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/density_fit.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr double kPilotEss = 250.0;      // sufficient effective draws of the pilot, or
constexpr double kPilotEssShare = 0.24;  // share of the draws of a round, if there are few
constexpr double kInitialShare = 0.10;   // share of P_0 in the data-driven part of q
constexpr double kStraightShare = 0.03;  // the same if the pilot's fit is settled and has no bends
constexpr double kMemoryFactor = 0.4;    // times lambda_q if it is settled: it fits this pack, not only the last one
constexpr double kLaplaceShare = 0.15;   // share of the Laplace fits there, once the pilot's fit exists
constexpr double kLackingShare = 0.5;    // the same if a part of the posterior has no block of the pilot
constexpr int kDrawsPerAnchor = 16;      // in a round: with fewer per anchor, more anchors do not help
constexpr double kNear = 2.0;            // standard deviations of the fit to this pack within which powers are series
constexpr std::size_t kFarShare = 4;     // 1 / share of the candidates beyond that, for which series do not pay
constexpr std::size_t kMostFar = Proposal::kMaxBatch / kFarShare;
constexpr std::array<double, 6> kTempers{0.5, 0.25, 0.1, 0.03, 0.01, 0.003};  // powers of the weights
constexpr FitOptions kPilotFit{
    .bandwidth_factor = 1.2, .tail_weight = 0.1, .tail_sd = 1.8, .inflation = 1.05, .shrink_to_normal = true};
constexpr double kTailInflation = 2.5;  // of the straightened coordinates, for the tails of a bent fit

/// The same bends with heavier tails: each straightened coordinate by `law`, and wider.
DensityBlock WithHeavyTails(const DensityBlock& fit, const MarginalTable* law) noexcept {
  DensityBlock wide = fit;
  for (int i = 0; i < wide.dim; ++i) {
    const auto ii = static_cast<std::size_t>(i);
    wide.marginal[ii] = law;
    wide.scale[ii] *= kTailInflation;
    wide.norm /= kTailInflation;
  }
  return wide;
}

}  // namespace

void ModeSampler::AddPersisted(double share, Proposal* proposal) const noexcept {
  for (int b = 0; b < num_persisted_; ++b)
    proposal->Add(&laplace_persisted_[static_cast<std::size_t>(b)], share / num_persisted_);
}

void ModeSampler::BuildProposal(const PosteriorMemory& previous, double lambda_q, bool use_previous,
                                int num_pilot_blocks, Proposal* proposal) noexcept {
  // A part of the posterior with too few pilot draws for a block is covered by the Laplace fits alone.
  const bool lacking = num_pilot_blocks == 0 || pilot_lacks_;
  // While a change is possible, both what persisted and what did not need every block that may draw them.
  const bool settled = !lacking && !(use_previous && may_have_changed_);
  if (settled) lambda_q = std::fmax(kMemoryFactor * lambda_q, sampler_.lambda_q_min);
  proposal->Clear();
  if (use_previous)
    for (int b = 0; b < previous.num_blocks; ++b)
      proposal->Add(&previous.block[static_cast<std::size_t>(b)],
                    lambda_q * std::fmax(previous.weight[static_cast<std::size_t>(b)], 0.05));
  const double rest = use_previous ? 1.0 - lambda_q : 1.0;
  // If a bend is extrapolated beyond what the pilot has seen, there may be no draws but those of P_0.
  bool straight = settled;
  for (int b = 0; b < num_pilot_blocks; ++b) straight = straight && !pilot_blocks_[static_cast<std::size_t>(b)].bent;
  const double initial = straight ? kStraightShare : kInitialShare;
  const double laplace = num_pilot_blocks == 0 ? 1.0 - initial : (lacking ? kLackingShare : kLaplaceShare);
  for (int b = 0; b < num_pilot_blocks; ++b)
    proposal->Add(&pilot_blocks_[static_cast<std::size_t>(b)], rest * (1.0 - initial - laplace) / num_pilot_blocks);
  // The pilot's blocks replace the Laplace fit of their part; after a modification, with P_0 alone in the target, it
  // is kept for the tails of blocks without bends.
  // The same holds for partial changes, several of which share one block of the pilot.
  if (use_previous && (lacking || transition_.Offers(previous))) {
    AddPersisted(0.6 * rest * laplace, proposal);
    proposal->Add(&laplace_fresh_, 0.4 * rest * laplace);
  } else if (!use_previous && settled && !straight) {
    // The Laplace fit leaves a bent ridge on a tangent. A draw of the posterior beyond the tails of the pilot's blocks
    // would have nothing but P_0 for it, and most of the weight.
    for (int b = 0; b < num_pilot_blocks; ++b) {
      const auto i = static_cast<std::size_t>(b);
      tail_blocks_[i] = WithHeavyTails(pilot_blocks_[i], &student_table_);
      proposal->Add(&tail_blocks_[i], rest * laplace / num_pilot_blocks);
    }
  } else if (!use_previous || may_have_changed_) {
    // If both are possible: a single draw of the posterior of P_0, far from the others, would have all the weight.
    proposal->Add(&laplace_fresh_, rest * laplace);
  }
  proposal->Add(&initial_block_, rest * initial);
  proposal->Normalise();
}

bool ModeSampler::BuildRidgeProposal(const ModeData& data, const PosteriorMemory& previous, bool use_previous,
                                     double lambda_q, int anchors, SamplerWorkspace* ws, Proposal* proposal) noexcept {
  const int dim = space_.dim;
  const Gaussian initial{ParamVector::Zero(dim), ParamMatrix::Identity(dim, dim)};
  // With one coordinate drawn anew the others constrain the posterior: the ridge is that of P_0.
  const bool partial = use_previous && transition_.Offers(previous);
  const bool follow_previous = use_previous && !partial;
  const Gaussian prior = follow_previous ? Gaussian{previous.mean, Inverse(previous.covariance)} : initial;
  const int found = FollowRidge(kernels_, model_, data, noise_, space_, prior,
                                follow_previous ? fit_persisted_ : fit_fresh_, anchors, &ws->laplace, &anchors_);
  if (found == 0) return false;
  proposal->Clear();
  if (use_previous)
    for (int b = 0; b < previous.num_blocks; ++b)
      proposal->Add(&previous.block[static_cast<std::size_t>(b)],
                    0.5 * lambda_q * previous.weight[static_cast<std::size_t>(b)] + 1e-3);
  for (int k = 0; k < found; ++k) {
    const auto i = static_cast<std::size_t>(k);
    SetElliptic(anchors_[i].mean, anchors_[i].covariance, kLaplaceInflation, &normal_table_, &ridge_blocks_[i]);
    proposal->Add(&ridge_blocks_[i], anchors_[i].share);
  }
  if (partial || num_persisted_ > 1) AddPersisted(1.0, proposal);
  proposal->Add(&laplace_fresh_, kInitialShare);
  proposal->Add(&initial_block_, kInitialShare);
  proposal->Normalise();
  return true;
}

const double* ModeSampler::GroupWeights(Origin origin, const PosteriorMemory& previous, double lambda, int first,
                                        int last, SamplerWorkspace* ws) const noexcept {
  double* const group = ws->group_weight.data();
  if (origin == Origin::kAny) {
    std::copy(ws->weight.data() + first, ws->weight.data() + last, group + first);
    return group;
  }
  const bool two = previous.num_blocks > 1;
  const double share_first = lambda * previous.weight[0] / memory_inside_;
  const double share_second = two ? lambda * previous.weight[1] / memory_inside_ : 0.0;
  const double share_changed = previous.num_blocks == 3 ? lambda * previous.weight[2] / memory_inside_ : 0.0;
  for (int k = first; k < last; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double changed =
        (1.0 - lambda) * ws->initial_prior[i] + (share_changed > 0.0 ? share_changed * ws->memory[2][i] : 0.0);
    const double of_first = share_first * ws->memory[0][i];
    const double of_second = two ? share_second * ws->memory[1][i] : 0.0;
    const double part = origin == Origin::kChanged ? changed
                                                   : (origin == Origin::kSecond ? 0.0 : of_first) +
                                                         (origin == Origin::kFirst ? 0.0 : of_second);
    group[k] = ws->weight[i] * (part / (changed + of_first + of_second + 1e-300));
  }
  return group;
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
  pilot_lacks_ = false;
  weighted.weight = GroupWeights(Origin::kAny, previous, lambda, first, last, ws) + offset;
  if (lambda > 0.0) {
    // Constant and changed parameters get a block each if both are probable, else those at rest and those that
    // drift. A group too small for a block is left out: if far away, it would make the other block too wide.
    const auto mass_of = [&](Origin origin) noexcept ARMCMC_NONBLOCKING {
      const double* const group = GroupWeights(origin, previous, lambda, first, last, ws);
      double mass = 0.0;
      for (int k = first; k < last; ++k) mass += group[k];
      return mass;
    };
    const auto counts = [](double share) noexcept { return share > 0.02 && share < 0.98; };
    const double total = mass_of(Origin::kAny);
    const double changed = may_have_changed_ ? mass_of(Origin::kChanged) / total : 0.0;
    std::array<Origin, 2> groups{Origin::kChanged, Origin::kPersisted};
    bool apart = counts(changed);
    if (!apart && drift_.Splits(previous) && counts(mass_of(Origin::kSecond) / total)) {
      groups = {Origin::kSecond, Origin::kFirst};
      apart = true;
    }
    if (apart) {
      int blocks = 0;
      double least = HUGE_VAL;
      *ess = 0.0;
      for (const Origin origin : groups) {
        (void)GroupWeights(origin, previous, lambda, first, last, ws);
        const double of_group = fit(weighted, blocks);
        blocks += of_group >= kMinimumEss ? 1 : 0;
        least = std::fmin(least, of_group);
        *ess += of_group;
      }
      pilot_lacks_ = blocks < 2;
      if (pilot_lacks_) *ess = least;
      return blocks;
    }
    if (may_have_changed_)
      (void)GroupWeights(changed > 0.5 ? Origin::kChanged : Origin::kPersisted, previous, lambda, first, last, ws);
    else
      (void)GroupWeights(Origin::kAny, previous, lambda, first, last, ws);
  }
  *ess = fit(weighted, 0);
  if (*ess >= kMinimumEss) return 1;
  // A few candidates have all the weight. The posterior to a power below one is broad enough to be fitted from them,
  // and has the same location: the next round draws from it.
  double top = 0.0;
  for (int k = first; k < last; ++k) top = std::fmax(top, ws->weight[static_cast<std::size_t>(k)]);
  if (!(top > 0.0)) return 0;
  pilot_lacks_ = true;
  for (const double power : kTempers) {
    for (int k = first; k < last; ++k) {
      const auto i = static_cast<std::size_t>(k);
      ws->group_weight[i] = std::pow(ws->weight[i] / top, power);
    }
    if (fit(weighted, 0) >= 2.0 * kMinimumEss) return 1;
  }
  return 0;
}

int ModeSampler::RunPilot(const ModeData& data, const PosteriorMemory& previous, bool use_previous, double lambda,
                          double lambda_q, int wanted, const DrawTime& time, const RandomStream& stream,
                          SamplerWorkspace* ws, Proposal* proposal, ModeDraws* out, bool* in_haste) noexcept {
  const int size = std::min(kPilotDraws, wanted / (2 * kPilotRounds) / kTileLanes * kTileLanes);
  const double enough = std::fmin(kPilotEss, kPilotEssShare * size);
  const int anchors = size / kDrawsPerAnchor;
  int made = 0;
  int pooled = 0;  // first draw of those with the proposal of this round
  int blocks = 0;
  bool on_ridge = false;
  Nanos worst_round_ns = 0;
  for (int round = 0; round < kMaxPilotRounds; ++round) {
    const Nanos before = time.clock.Now();
    DrawAndScore(*proposal, previous, data, made, size, stream, ws, out);
    made += size;
    double ess = 0.0;
    if (!std::isnan(Weigh(previous, lambda, pooled, made, ws)))
      blocks = FitPilot(previous, lambda, pooled, made, ws, *out, &ess);
    if (ess >= enough) {
      on_ridge = false;
      break;
    }
    const bool last = round + 1 == kMaxPilotRounds || (round + 1 >= kPilotRounds && made + size > wanted / 2);
    if (!last && size > 2 * kTileLanes) {  // shorter rounds cost nothing
      const int after_round = made + size + DrawsWithoutFullPilot(made + size, wanted);
      if (after_round > time.limit) break;
      const Nanos now = time.clock.Now();
      worst_round_ns = std::max(worst_round_ns, now - before);
      const Nanos ridge_ns = round == 0 ? TimeOfRidge(anchors, time.anchor_ns) : 0;
      const Nanos ahead =
          ridge_ns + worst_round_ns * (after_round - made) / size + TimeAfter(after_round, time.informed);
      *in_haste = now + ahead > time.deadline_ns;
      if (*in_haste) break;
    }
    if (round == 0 && drift_.Splits(previous)) FitConstantAndDrifting(data, previous, ws);
    const bool thin_but_right = on_ridge && (round > 1 || ess >= kMinimumEss);
    if (!thin_but_right) {  // otherwise more draws from the same proposal
      pooled = made;
      const Nanos ridge_start = time.clock.Now();
      on_ridge = round == 0 && BuildRidgeProposal(data, previous, use_previous, lambda_q, anchors, ws, proposal);
      if (on_ridge) ridge_time_.Add(time.clock.Now() - ridge_start, anchors);
      if (!on_ridge) BuildProposal(previous, lambda_q, use_previous, blocks, proposal);
    }
    if (last) break;
  }
  if (!on_ridge) {
    BuildProposal(previous, lambda_q, use_previous, blocks, proposal);
  } else if (blocks > 0) {
    for (int b = 0; b < blocks; ++b) proposal->Add(&pilot_blocks_[static_cast<std::size_t>(b)], 0.5 / blocks);
    proposal->Normalise();
  }
  return made;
}

void ModeSampler::PrepareScore(const ModeData& data, bool use_previous, SamplerWorkspace* ws) noexcept {
  const Gaussian& fit = use_previous ? fit_persisted_ : fit_fresh_;
  quadratic_.Prepare(data, fit, &ws->quadratic);
  ws->powers.parameter = -1;
  if (noise_.kind() == NoiseKind::kGaussian) return;
  // Candidates are about as wide as the posterior of this pack alone: wider ones are few.
  const ParamMatrix covariance = Inverse(fit_fresh_.precision);
  std::array<double, kMaxParams> middle{};
  std::array<double, kMaxParams> reach{};
  for (int d = 0; d < space_.num_parameters; ++d) {
    const auto i = static_cast<std::size_t>(d);
    middle[i] = space_.Theta(d, fit.mean[d]);
    reach[i] = kNear * space_.scale[i] * std::sqrt(covariance(d, d));
  }
  kernels_.expand_power(model_, data, middle.data(), reach.data(), &ws->powers);
}

bool ModeSampler::ScoreNear(const ModeData& data, int first, int end, double* const* u,
                            SamplerWorkspace* ws) const noexcept {
  const PowerSeries& powers = ws->powers;
  const double* const exponent = u[powers.parameter];
  std::array<std::int16_t, kMostFar + kTileLanes>
      far;  // NOLINT(cppcoreguidelines-pro-type-member-init): written before read
  std::size_t num_far = 0;
  const std::size_t most = std::min(kMostFar, static_cast<std::size_t>(end - first) / kFarShare);
  for (int k = first; k < end; ++k) {
    if (std::fabs(space_.Theta(powers.parameter, exponent[k]) - powers.middle) <= powers.reach) continue;
    if (num_far == most) return false;
    far[num_far++] = static_cast<std::int16_t>(k - first);
  }
  alignas(64) std::array<double, kTileLanes> log_scale;
  for (int k = first; k < end; k += kTileLanes) {
    kernels_.to_physical(space_, u, k, ws->theta.data(), log_scale.data());
    kernels_.score_near(model_, noise_, data, &powers, ws->theta[0], log_scale.data(), kTileLanes,
                        &ws->log_likelihood[static_cast<std::size_t>(k)]);
  }
  // Those out of reach once more, side by side.
  for (std::size_t begin = 0; begin < num_far; begin += kTileLanes) {
    alignas(64) std::array<std::array<double, kTileLanes>, kMaxParams> few;
    std::array<const double*, kMaxParams> rows{};
    const auto candidate = [&](std::size_t lane) noexcept {
      return static_cast<std::size_t>(first + far[std::min(begin + lane, num_far - 1)]);
    };
    for (std::size_t d = 0; d < static_cast<std::size_t>(space_.dim); ++d) {
      for (std::size_t lane = 0; lane < kTileLanes; ++lane) few[d][lane] = u[d][candidate(lane)];
      rows[d] = few[d].data();
    }
    alignas(64) std::array<double, kTileLanes> score;
    kernels_.to_physical(space_, rows.data(), 0, ws->theta.data(), log_scale.data());
    const std::size_t lanes = std::min<std::size_t>(num_far - begin, kTileLanes);
    kernels_.score_near(model_, noise_, data, nullptr, ws->theta[0], log_scale.data(), static_cast<int>(lanes),
                        score.data());
    for (std::size_t lane = 0; lane < lanes; ++lane) ws->log_likelihood[candidate(lane)] = score[lane];
  }
  return true;
}

void ModeSampler::ScoreAll(const ModeData& data, int first, int end, double* const* u,
                           SamplerWorkspace* ws) const noexcept {
  alignas(64) std::array<double, 2 * kTileLanes> log_scale;
  for (int k = first; k < end; k += 2 * kTileLanes) {
    const bool two = k + kTileLanes < end;
    kernels_.to_physical(space_, u, k, &ws->theta[0], log_scale.data());
    if (two) kernels_.to_physical(space_, u, k + kTileLanes, &ws->theta[1], log_scale.data() + kTileLanes);
    double* const out_k = &ws->log_likelihood[static_cast<std::size_t>(k)];
    if (two) {
      kernels_.score_two(model_, noise_, data, ws->theta, log_scale.data(), &ws->prediction, out_k);
    } else {
      kernels_.score(model_, noise_, data, ws->theta[0], log_scale.data(), &ws->prediction, out_k);
    }
  }
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

  if (quadratic_.ready()) {
    for (int k = first; k < end; k += kTileLanes)
      quadratic_.Score(u, k, &ws->log_likelihood[static_cast<std::size_t>(k)]);
  } else if (ws->powers.parameter < 0 || !ScoreNear(data, first, end, u, ws)) {
    ScoreAll(data, first, end, u, ws);
  }
  for (int k = first; k < end; k += kTileLanes) {
    const auto at = static_cast<std::size_t>(k);
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
