#include "armcmc/transition.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/density_fit.hpp"
#include "armcmc/linear_algebra.hpp"
#include "armcmc/snapshot.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr double kChangeShare = 0.5;  // weight of "one parameter changed" in the prior after a modification

double LogDeterminant(const ParamMatrix& m) noexcept ARMCMC_NONBLOCKING {
  const ParamVector diagonal = SymmetricFactor(m).Diagonal();
  double sum = 0.0;
  for (Eigen::Index i = 0; i < m.rows(); ++i) sum += std::log(std::fmax(diagonal[i], 1e-300));
  return sum;
}

}  // namespace

Transition::Transition(const simd::Kernels& kernels, int model, const ParameterSpace& space, const NoiseModel& noise,
                       const MarginalTable* normal_table, bool partial_change)
    : kernels_(kernels),
      model_(model),
      space_(space),
      noise_(noise),
      normal_table_(normal_table),
      partial_change_(partial_change),
      moved_(ParamVector::Zero(space.dim)),
      widened_(ParamVector::Zero(space.dim)) {}

Transition::Hypothesis Transition::Judge(const ModeData& data, const ParamVector& mean, const ParamMatrix& covariance,
                                         const ParamVector& start, LaplaceScratch* scratch) const noexcept {
  Hypothesis h;
  h.mean = mean;
  h.covariance = covariance;
  const Gaussian prior{mean, Inverse(covariance)};
  const double height =
      LaplaceFit(kernels_, model_, data, noise_, space_, prior, start, kModeTolerance, scratch, &h.fit);
  h.log_evidence = height + 0.5 * (LogDeterminant(prior.precision) - LogDeterminant(h.fit.precision));
  if (!std::isfinite(h.log_evidence)) h.log_evidence = -HUGE_VAL;
  return h;
}

void Transition::SetMemory(const PosteriorMemory& previous, const Hypothesis* hypotheses, int count) noexcept {
  memory_.valid = true;
  memory_.informed = previous.informed;
  memory_.num_blocks = count;
  for (int b = 0; b < count; ++b) {
    const auto i = static_cast<std::size_t>(b);
    SetElliptic(hypotheses[b].mean, hypotheses[b].covariance, 1.0, normal_table_, &memory_.block[i]);
    memory_.weight[i] = 1.0 / count;
    fits_[i] = hypotheses[b].fit;
  }
  memory_.mean = hypotheses[0].mean;
  memory_.covariance = hypotheses[0].covariance;
  memory_.log_noise_scale = previous.log_noise_scale;
}

bool Transition::OfferChanges(const ModeData& data, const PosteriorMemory& previous, bool reinforcement,
                              LaplaceScratch* scratch) noexcept {
  // The posterior after a modification is not used as a base: its pack may contain the jump.
  const bool from_stable = just_modified_ && stable_;
  ParamVector base = previous.mean;
  ParamMatrix covariance = previous.covariance;
  if (from_stable) {
    base = stable_mean_ + moved_;
    covariance = stable_covariance_;
    covariance.diagonal() += widened_;
  }
  std::array<Hypothesis, PosteriorMemory::kMaxBlocks> best;
  for (auto& h : best) h.log_evidence = -HUGE_VAL;
  const auto offer = [&](const Hypothesis& h) noexcept ARMCMC_NONBLOCKING {
    if (h.log_evidence > best[0].log_evidence) {
      best[1] = best[0];
      best[0] = h;
    } else if (h.log_evidence > best[1].log_evidence) {
      best[1] = h;
    }
  };
  // The last coordinate may be the noise scale: a gross outlier indicates larger noise rather than a changed plant.
  for (int j = 0; j < space_.dim; ++j) {
    ParamVector mean = base;
    ParamMatrix c = covariance;
    mean[j] = 0.0;
    c.row(j).setZero();
    c.col(j).setZero();
    c(j, j) = 1.0;
    offer(Judge(data, mean, c, base, scratch));
  }
  if (from_stable) offer(Judge(data, base, covariance, base, scratch));
  if (reinforcement) {
    const double current = Judge(data, previous.mean, previous.covariance, previous.mean, scratch).log_evidence;
    if (!(best[0].log_evidence > current)) return false;
  }
  if (!std::isfinite(best[0].log_evidence)) return false;
  SetMemory(previous, best.data(), std::isfinite(best[1].log_evidence) ? 2 : 1);
  return true;
}

void Transition::Age(const PosteriorMemory& before, const PosteriorMemory& now) noexcept {
  moved_ = now.mean - before.mean;
  for (Eigen::Index i = 0; i < widened_.size(); ++i)
    widened_[i] = std::fmax(now.covariance(i, i) - before.covariance(i, i), 0.0);
}

const PosteriorMemory& Transition::Choose(const ModeData& data, const PosteriorMemory& previous, Mismatch* mismatch,
                                          double* share, LaplaceScratch* scratch) noexcept {
  restarted_ = false;
  if (!previous.valid) stable_ = just_modified_ = false;
  *share = mismatch->lambda;
  if (!partial_change_ || !previous.valid || !previous.informed) return previous;
  const bool reinforcement = mismatch->decision == Decision::kReinforcement;
  if (!reinforcement || (just_modified_ && stable_)) {
    if (OfferChanges(data, previous, reinforcement, scratch)) {
      restarted_ = reinforcement;
      mismatch->decision = Decision::kModification;
      mismatch->lambda = 0.0;
      *share = kChangeShare;
      return memory_;
    }
  }
  return previous;
}

void Transition::Accept(const PosteriorMemory& next, Decision decision) noexcept {
  // A restart already used this pack as the first of the new plant; another restart would lose its information.
  just_modified_ = decision == Decision::kModification && !restarted_;
  if (just_modified_) {
    if (stable_) {
      stable_mean_ += moved_;
      stable_covariance_.diagonal() += widened_;
    }
    return;
  }
  stable_ = next.informed;
  stable_mean_ = next.mean;
  stable_covariance_ = next.covariance;
}

void Transition::Save(SnapshotWriter* out) const noexcept {
  out->PutFlag(just_modified_);
  out->PutFlag(stable_);
  if (!stable_) return;
  out->PutRow(stable_mean_.data(), static_cast<std::size_t>(stable_mean_.size()));
  out->PutRow(stable_covariance_.data(), static_cast<std::size_t>(stable_covariance_.size()));
}

void Transition::Restore(SnapshotReader* in) noexcept {
  just_modified_ = in->Flag();
  stable_ = in->Flag();
  if (!stable_) return;
  const int dim = space_.dim;
  stable_mean_.resize(dim);
  stable_covariance_.resize(dim, dim);
  in->Row(stable_mean_.data(), static_cast<std::size_t>(dim));
  in->Row(stable_covariance_.data(), static_cast<std::size_t>(dim * dim));
  in->Require(in->good() && IsPositiveDefinite(stable_covariance_));
  stable_ = in->good();
}

}  // namespace armcmc
