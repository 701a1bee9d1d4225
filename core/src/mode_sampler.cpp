#include "armcmc/mode_sampler.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "armcmc/density_fit.hpp"
#include "armcmc/sample_size.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr double kChanges = 0.01;    // share of P_0 in the prior above which its posterior is always drawn
constexpr double kRefitShare = 0.4;  // effective share of the draws below which the proposal is refitted

enum Purpose : std::uint64_t {
  kMismatchStream = 0,
  kDrawStream = 1,
  kAcceptStream = 2,
  kStartStream = 3,
  kNumPurposes = 4
};

/// One for all samplers: where several take turns, it stays in the cache.
const MarginalTable& StudentTable() {
  static const MarginalTable table = MarginalTable::StudentT(ModeSampler::kStudentDof);
  return table;
}

}  // namespace

SamplerWorkspace::SamplerWorkspace(int dim, int capacity, int num_linear) : quadratic(num_linear) {
  const auto cap = static_cast<std::size_t>(std::max(RoundUpToTile(capacity), Proposal::kMaxBatch) + kTileLanes);
  for (auto* v : {&log_likelihood, &proposal, &initial_prior, &weight, &group_weight, &first_share}) v->resize(cap);
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
                         const ForgettingSettings& forgetting, const ParameterSpace& space, const NoiseModel& noise,
                         const LinearPart& linear, std::shared_ptr<Drift::Scratch> drift_scratch)
    : kernels_(kernels),
      model_(model),
      sampler_(sampler),
      forgetting_(forgetting),
      space_(space),
      noise_(noise),
      quadratic_(kernels_, model_, space_, noise_, sampler.use_linearity ? linear : LinearPart{}),
      normal_table_(MarginalTable::Normal()),
      student_table_(StudentTable()),
      transition_(kernels_, model_, space_, noise_, &normal_table_, forgetting.partial_change),
      drift_(kernels_, model_, space_, noise_, forgetting.drift_share, std::move(drift_scratch)) {
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
  Mismatch best = CompareBlocks(data, previous, 0, previous.num_blocks, stream, ws);
  if (best.decision == Decision::kReinforcement || !drift_.Splits(previous)) return best;
  for (int b = 0; b < previous.num_blocks; ++b) {
    const Mismatch part = CompareBlocks(data, previous, b, b + 1, stream, ws);
    if (part.lambda > best.lambda) best = part;
  }
  return best;
}

Mismatch ModeSampler::CompareBlocks(const ModeData& data, const PosteriorMemory& previous, int first, int last,
                                    const RandomStream& stream, SamplerWorkspace* ws) const noexcept {
  std::array<double*, kMaxParams> u{};
  for (int d = 0; d < space_.dim; ++d)
    u[static_cast<std::size_t>(d)] = ws->mismatch_u[static_cast<std::size_t>(d)].data();
  Proposal memory;
  for (int b = first; b < last; ++b)
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
  for (int k = 0; k < kMismatchDraws; k += kTileLanes) {
    kernels_.to_physical(space_, u.data(), k, ws->theta.data(), log_scale.data());
    kernels_.predict(model_, data, ws->theta[0], &ws->prediction);
    std::array<double, kTileLanes> lane_mean{};
    for (int n = 0; n < data.num_samples; ++n) {
      const auto in = static_cast<std::size_t>(n);
      // Differences from the first draw keep the variance of a narrow posterior from cancelling.
      if (k == 0) p.mean[in] = ws->prediction.value[in][0];
      for (std::size_t l = 0; l < kTileLanes; ++l) lane_mean[l] += ws->prediction.value[in][l];
    }
    for (std::size_t l = 0; l < kTileLanes; ++l) {
      const double m = lane_mean[l] / data.num_samples;
      mean_sum += m;
      mean_square += m * m;
    }
    // Second pass over the tile: running first and second moments about the reference in p.mean.
    for (int n = 0; n < data.num_samples; ++n) {
      const auto in = static_cast<std::size_t>(n);
      std::array<double, 4> sum{};  // several sums, so that they are independent of each other
      std::array<double, 4> squares{};
      const double reference = p.mean[in];
      for (std::size_t l = 0; l < kTileLanes; l += 4)
        for (std::size_t i = 0; i < 4; ++i) {
          const double d = ws->prediction.value[in][l + i] - reference;
          sum[i] += d;
          squares[i] += d * d;
        }
      ws->group_weight[in] = (k == 0 ? 0.0 : ws->group_weight[in]) + ((sum[0] + sum[1]) + (sum[2] + sum[3]));
      p.variance[in] += (squares[0] + squares[1]) + (squares[2] + squares[3]);
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
  const Eigen::Index noise = space_.dim - 1;
  p.log_noise_sd = space_.samples_noise_scale()
                       ? space_.scale[static_cast<std::size_t>(noise)] * std::sqrt(previous.covariance(noise, noise))
                       : 0.0;
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

Status ModeSampler::Run(const ModeData& data, const PosteriorMemory& before, std::uint64_t pack, std::uint64_t mode,
                        Nanos deadline_ns, ClockRef clock, int limit, SamplerWorkspace* ws, ModeDraws* out) noexcept {
  const auto stream_of = [&](Purpose purpose) noexcept {
    return RandomStream(sampler_.seed, pack, mode * kNumPurposes + purpose);
  };
  const PosteriorMemory& last = drift_.Carry(data, before, &ws->laplace);
  const Drift::Expected* expected = drift_.expected();
  drifted_.any = expected != nullptr;
  if (drifted_.any)
    drifted_ = {true, data.time_s, before.mean, expected->mean, before.covariance, expected->covariance};
  if (before.valid) transition_.Age(before, last);
  Mismatch mismatch;
  mismatch.zeta = HUGE_VAL;  // zeta^0: the first pack is a modification
  mismatch.threshold = forgetting_.threshold;
  if (last.valid) mismatch = Compare(data, last, stream_of(kMismatchStream), ws);
  double lambda = 0.0;  // share of `previous` in the prior; the paper's lambda is mismatch.lambda
  const PosteriorMemory& previous = transition_.Choose(data, last, &mismatch, &lambda, &ws->laplace);
  const bool use_previous = lambda > 0.0;
  const int wanted = DrawTarget(mismatch, out);
  int target = std::clamp(limit, SamplerSettings::kMinDraws, wanted);
  // After a partial change one coordinate is as wide as P_0: the density is a poor proposal for the posterior.
  const double lambda_q = transition_.Offers(previous)
                              ? sampler_.lambda_q_min
                              : std::clamp(lambda, sampler_.lambda_q_min, sampler_.lambda_q_max);

  may_have_changed_ = lambda < 1.0 - kChanges || lambda * previous.weight[2] > kChanges;
  const bool informed = last.valid && last.informed;  // otherwise the result is complete only after Remember()
  const Nanos fit_start = clock.Now();
  FitLaplace(data, previous, use_previous, stream_of(kStartStream), ws);
  PrepareScore(data, use_previous, ws);
  const Nanos anchor_ns =
      (clock.Now() - fit_start) / laplace_fits_;  // an upper bound, since they start close to each other
  Proposal proposal;
  pilot_lacks_ = false;
  BuildProposal(previous, lambda_q, use_previous, 0, &proposal);
  const RandomStream stream = stream_of(kDrawStream);
  memory_inside_ = 1.0;
  bool in_haste = false;
  int pilot = RunPilot(data, previous, use_previous, lambda, lambda_q, wanted,
                       {deadline_ns, clock, limit, anchor_ns, informed}, stream, ws, &proposal, out, &in_haste);
  if (in_haste) target = pilot + DrawsWithoutFullPilot(pilot, wanted);

  // A truncated run ends between two chunks. Only the end of the loop depends on `limit`: a run limited to as many
  // draws makes the same chunks, and so repeats it to the bit.
  int made = pilot;
  bool refitted = false;
  double worst_draw_ns = 0.0;
  Nanos draw_ns = 0;
  int timed = 0;
  double slowness = 1.0;
  while (made < target || made == pilot) {  // at most max(8, max_draws / kChunkDraws) + 2 turns
    // A replay infers the number of pilot rounds from the draws after the pilot: at least those of a hurried pack.
    const int several =
        made == pilot ? std::max(DrawsWithoutFullPilot(pilot, wanted), ChunkDraws(wanted)) : ChunkDraws(wanted);
    const int chunk = std::min(several, (made < target ? target : wanted) - made);
    const Nanos start = clock.Now();
    const double ahead = worst_draw_ns * chunk + slowness * static_cast<double>(TimeAfter(made + chunk, informed));
    if (made > pilot && start + static_cast<Nanos>(ahead) > deadline_ns) break;
    DrawAndScore(proposal, previous, data, made, chunk, stream, ws, out);
    made += chunk;
    timed += chunk;
    const Nanos spent = clock.Now() - start;
    draw_ns += spent;
    worst_draw_ns = std::max(worst_draw_ns, static_cast<double>(spent) / chunk);
    slowness = draw_pace_.Slowness(draw_ns, timed);
    // One late correction, within the discarded half of the chain: if the pilot was a poor match, the draws so far give
    // a better proposal. It is skipped if drawing is finished, short of time or at a limit, since it would need
    // another chunk.
    if (!refitted && made < target && wanted > 2 * kChunkDraws && made >= wanted / 4 && made + kChunkDraws <= wanted) {
      refitted = true;
      double ess = 0.0;
      if (std::isnan(Weigh(previous, lambda, pilot, made, ws))) continue;
      std::array<double, 2> sums{};
      kernels_.first_moments(0, nullptr, &ws->weight[static_cast<std::size_t>(pilot)], made - pilot, sums.data());
      if (sums[0] * sums[0] > kRefitShare * (made - pilot) * sums[1]) continue;
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
  // The first components of the proposal.
  std::fill_n(&ws->component[static_cast<std::size_t>(made)], kTileLanes, std::int8_t{Proposal::kMaxComponents});
  const simd::Kernels::Chosen memory =
      kernels_.count_chosen(ws->component.data(), memory_components, ws->initial_prior.data(), RoundUpToTile(made));
  memory_inside_ = memory.chosen > 0 ? std::fmax(memory.inside, 1.0) / memory.chosen : 1.0;
  const double reference = Weigh(previous, lambda, 0, made, ws);
  if (std::isnan(reference)) return Status::kNonFinite;

  // The pilot's draws are part of the chain, which discards them, and not of the importance estimate.
  std::array<double, 2> sums{};
  kernels_.first_moments(0, nullptr, &ws->weight[static_cast<std::size_t>(pilot)], made - pilot, sums.data());
  const double sum = sums[0];
  const double square = sums[1];
  if (!(sum > 0.0)) return Status::kNonFinite;
  out->mode_index = kernels_.largest_product(
      ws->weight.data(), sampler_.use_proposal_ratio ? ws->proposal.data() : nullptr, RoundUpToTile(made));
  const int padded = pilot + RoundUpToTile(made - pilot);
  std::fill(out->weight, out->weight + pilot, 0.0);
  kernels_.divide(&ws->weight[static_cast<std::size_t>(pilot)], sum, padded - pilot, out->weight + pilot);
  std::fill(out->weight + made, out->weight + padded, 0.0);
  out->kish_ess = sum * sum / square;
  const bool calibrated = ReduceSamplingError(pilot, made, use_previous, ws, out);
  out->log_evidence = reference + std::log(sum / (made - pilot));
  out->decision = mismatch.decision;
  out->zeta = mismatch.zeta;
  out->zeta_threshold = mismatch.threshold;
  out->lambda = mismatch.lambda;
  out->num_samples = data.num_samples;
  FindMode(data, !use_previous, ws, out);
  RunChain(stream_of(kAcceptStream), pilot, ws, out);
  unfinished_ = {.data = &data,
                 .previous = &previous,
                 .lambda = lambda,
                 .first = pilot,
                 .mass_first = 0.0,
                 .mass_new = 1.0,
                 .mass_changed = 1.0};
  unfinished_.calibrated = calibrated;
  SplitMassByPrior(ws, out);
  FindEndOfPack(data, ws, out);
  out->known = informed;
  out->updated = true;
  // Each at its usual speed: a pack that was slow throughout does not affect the estimate for the next.
  finish_time_.Add(static_cast<Nanos>(static_cast<double>(clock.Now() - finish_start) / slowness), made);
  draw_pace_.Add(draw_ns, timed);
  return out->truncated ? Status::kTruncated : Status::kOk;
}

void ModeSampler::Remember(ClockRef clock, SamplerWorkspace* ws, PosteriorMemory* next, ModeDraws* out) noexcept {
  const Nanos start = clock.Now();
  Compress(ws, next, out);
  double log_scale = space_.log_noise_scale;
  if (space_.samples_noise_scale()) {
    const auto d = static_cast<std::size_t>(space_.dim - 1);
    double mean = 0.0;
    for (int k = 0; k < out->draws; ++k) mean += out->weight[k] * out->u[d][k];
    log_scale = space_.Theta(space_.dim - 1, mean);
  }
  next->log_noise_scale = log_scale;
  transition_.Accept(*next, out->decision);
  // The more probable posterior may be one that was the less probable one, or new.
  const bool another =
      !unfinished_.split && unfinished_.lambda > 0.0 && (unfinished_.mass_first < 0.5) != unfinished_.first_changed;
  drift_.Learn(*unfinished_.data, *next, DrawsForDrift(ws, *out), unfinished_.part,
               unfinished_.split && next->num_blocks == 2, out->p_changed > 0.5 || another, &ws->laplace);
  if (!out->known) out->known = next->informed;  // if it is already, another thread may be reading the result
  remember_time_.Add(clock.Now() - start, out->draws);
}

}  // namespace armcmc
