// What a pack teaches the bank, and what the sampler sees of a pack in which the parameters move.
#include <array>
#include <cmath>

#include "armcmc/drift.hpp"
#include "armcmc/linear_algebra.hpp"

namespace armcmc {

const ModeData& Drift::MovedToEnd(const ModeData& data, const PosteriorMemory& last, LaplaceScratch* scratch) noexcept {
  velocity_ = ParamVector::Zero(dim_);
  if (CarriedPart() != Part::kDrift) return data;
  ParamVector velocity = ParamVector::Zero(dim_);
  double weight = 0.0;
  for (std::size_t i = 0; i < predicted_.size(); ++i) {
    const Filter& f = predicted_[i];
    if (!IsOf(Part::kDrift, i) || !(f.weight > 0.0)) continue;
    weight += f.weight;
    velocity += f.weight * f.w;
  }
  velocity /= weight;
  std::array<double, kMaxPackSamples> slope{};
  DerivativeAlong(kernels_, model_, data, space_, last.mean.head(dim_), velocity, scratch, slope.data());
  moved_ = data;
  moved_.error_tape = nullptr;
  for (int n = 0; n < data.num_samples; ++n) {
    const auto in = static_cast<std::size_t>(n);
    if (!std::isfinite(slope[in])) return data;
    moved_.target[in] += data.TimeToEnd(n) * slope[in];
  }
  velocity_ = velocity;
  return moved_;
}

Drift::Moments Drift::AsSampled(const Sampled& sampled) const noexcept {
  const LocalLikelihood& local = sampled.local;
  const JointVector gradient = local.gradient + Multiply(local.lagged_information, velocity_);
  const JointMatrix information = local.information;
  const auto update = [&](const ParamVector& mean, const ParamMatrix& covariance, Moments* out) noexcept
                      ARMCMC_NONBLOCKING {
    JointVector apart = mean - sampled.mean;
    JointMatrix spread = covariance;
    const double log_evidence = MultiplyByQuadratic(gradient, information, &apart, &spread);
    out->mean = sampled.mean + apart;
    out->covariance = spread;
    return log_evidence;
  };
  // The sampler's prior was the bank, or a Gaussian with its moments.
  if (!(sampled.part == Part::kDrift ? mixed_ : split_ && sampled.part == Part::kWhole)) {
    const Moments prior = MomentsOf(predicted_, sampled.part);
    Moments now{.weight = 1.0, .mean = {}, .covariance = {}};
    (void)update(prior.mean, prior.covariance, &now);
    return now;
  }
  Members members;
  std::array<double, kFilters> log_weight{};
  double top = -HUGE_VAL;
  for (std::size_t i = 0; i < predicted_.size(); ++i) {
    const Filter& f = predicted_[i];
    members[i] = {.weight = 0.0, .mean = f.u, .covariance = f.uu};
    if (!IsOf(sampled.part, i) || !(f.weight > 0.0)) continue;
    members[i].weight = 1.0;
    log_weight[i] = std::log(f.weight) + update(f.u, f.uu, &members[i]);
    top = std::fmax(top, log_weight[i]);
  }
  for (std::size_t i = 0; i < members.size(); ++i)
    if (members[i].weight > 0.0) members[i].weight = std::exp(log_weight[i] - top);
  return MomentsOf(members);
}

bool Drift::Update(const Sampled& sampled, Part part, double weight) noexcept {
  const LocalLikelihood& local = sampled.local;
  const Eigen::Index n = dim_;
  JointVector gradient(2 * n);
  gradient.head(n) = local.gradient;
  gradient.tail(n) = -local.lagged_gradient;
  JointMatrix information(2 * n, 2 * n);
  information.topLeftCorner(n, n) = local.information;
  information.topRightCorner(n, n) = information.bottomLeftCorner(n, n) = -local.lagged_information;
  information.bottomRightCorner(n, n) = local.twice_lagged_information;
  std::array<double, kFilters> log_weight{};
  double top = -HUGE_VAL;
  for (std::size_t i = 0; i < bank_.size(); ++i) {
    if (!IsOf(part, i)) continue;
    Filter& f = bank_[i];
    f = predicted_[i];
    if (!(f.weight > 0.0)) continue;
    const bool rests = HypothesisOf(i) == 0;
    const Eigen::Index size = rests ? n : 2 * n;
    JointVector state(size);
    JointMatrix spread(size, size);
    state.head(n) = f.u - sampled.mean;
    spread.topLeftCorner(n, n) = f.uu;
    if (rests) {
      log_weight[i] = MultiplyByQuadratic(local.gradient, local.information, &state, &spread);
    } else {
      state.tail(n) = f.w;
      spread.topRightCorner(n, n) = f.uw;
      spread.bottomLeftCorner(n, n) = f.uw.transpose();
      spread.bottomRightCorner(n, n) = f.ww;
      log_weight[i] = MultiplyByQuadratic(gradient, information, &state, &spread);
      f.w = state.tail(n);
      f.uw = spread.topRightCorner(n, n);
      f.ww = spread.bottomRightCorner(n, n);
    }
    f.u = sampled.mean + state.head(n);
    f.uu = spread.topLeftCorner(n, n);
    log_weight[i] += std::log(f.weight);
    top = std::fmax(top, log_weight[i]);
    if (!std::isfinite(log_weight[i]) || !state.allFinite() || !spread.allFinite()) return false;
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < bank_.size(); ++i) {
    if (!IsOf(part, i)) continue;
    if (bank_[i].weight > 0.0) bank_[i].weight = std::exp(log_weight[i] - top);
    sum += bank_[i].weight;
  }
  for (std::size_t i = 0; i < bank_.size(); ++i)
    if (IsOf(part, i)) bank_[i].weight *= weight / sum;
  return true;
}

}  // namespace armcmc
