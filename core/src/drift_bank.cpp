// The bank of filters between packs: generations, newcomers, time.
#include <algorithm>
#include <array>
#include <cmath>

#include "armcmc/drift.hpp"
#include "armcmc/linear_algebra.hpp"
#include "fixed_size.hpp"

namespace armcmc {

Drift::Moments Drift::MomentsOf(const Bank& bank, Part part, std::size_t first) const noexcept {
  Moments m{.weight = 0.0, .mean = ParamVector::Zero(dim_), .covariance = ParamMatrix::Zero(dim_, dim_)};
  for (std::size_t i = first * kHypotheses; i < bank.size(); ++i) {
    if (!IsOf(part, i) || !(bank[i].weight > 0.0)) continue;
    m.weight += bank[i].weight;
    m.mean += bank[i].weight * bank[i].u;
  }
  m.mean /= m.weight;
  WithFixedSize(dim_, [&]<class F>(F) noexcept ARMCMC_NONBLOCKING {
    auto covariance = F::Of(&m.covariance);
    const auto mean = F::Of(m.mean);
    for (std::size_t f = first * kHypotheses; f < bank.size(); ++f) {
      if (!IsOf(part, f) || !(bank[f].weight > 0.0)) continue;
      const typename F::Vector apart = F::Of(bank[f].u) - mean;
      covariance += (bank[f].weight / m.weight) * (F::Of(bank[f].uu) + apart.lazyProduct(apart.transpose()));
    }
  });
  return m;
}

void Drift::MakeRoom(Bank* bank) const noexcept {
  for (std::size_t h = 0; h < static_cast<std::size_t>(NumHypotheses(dim_)); ++h) {
    const MovingParameters moving = hypotheses_[h].Moving(dim_);
    const auto slot = [bank, h](std::size_t k) noexcept ARMCMC_NONBLOCKING -> Filter& {
      return (*bank)[k * kHypotheses + h];
    };
    std::size_t first = kSlots;  // of those in use, which move to the end
    const auto keep = [&](std::size_t k) noexcept ARMCMC_NONBLOCKING {
      if (!(slot(k).weight > 0.0)) return;
      if (--first == k) return;
      slot(first) = slot(k);
      slot(k).weight = 0.0;
    };
    for (std::size_t k = kSlots; k-- > 0;) keep(k);
    if (first >= kNewcomers) continue;
    const auto volume_of = [&moving](const Filter& f) noexcept ARMCMC_NONBLOCKING {
      return f.weight * f.LogVolume(moving);
    };
    std::array<double, kSlots> volume{};
    std::array<double, kSlots> lost{};  // by merging it with the next one
    const auto find_lost = [&](std::size_t k) noexcept ARMCMC_NONBLOCKING {
      if (k < first || k + 1 >= kSlots) return;
      Filter later = slot(k);
      Filter both = slot(k + 1);
      both.Absorb(&later);
      lost[k] = volume_of(both) - volume[k] - volume[k + 1];
    };
    for (std::size_t k = first; k < kSlots; ++k) volume[k] = volume_of(slot(k));
    for (std::size_t k = first; k + 1 < kSlots; ++k) find_lost(k);
    while (first < kNewcomers) {
      std::size_t merged = first;
      double least = HUGE_VAL;
      for (std::size_t k = first; k + 1 < kSlots; ++k) {
        if (!(lost[k] < least)) continue;
        least = lost[k];
        merged = k;
      }
      slot(merged + 1).Absorb(&slot(merged));
      volume[merged + 1] = volume_of(slot(merged + 1));
      for (std::size_t k = merged; k > first; --k) {
        slot(k) = slot(k - 1);
        volume[k] = volume[k - 1];
        lost[k] = lost[k - 1];
      }
      slot(first++).weight = 0.0;
      find_lost(merged);
      find_lost(merged + 1);
    }
  }
}

ParamMatrix Drift::FirstVelocity(const Hypothesis& law) const noexcept {
  ParamMatrix covariance = ParamMatrix::Zero(dim_, dim_);
  for (int d = 0; d < dim_; ++d) covariance(d, d) = law.Moves(d) ? law.rate * law.rate : 0.0;
  return covariance;
}

Drift::Filter Drift::Newcomer(const Moments& part, double weight, const Hypothesis& law) const noexcept {
  return {.weight = weight * part.weight,
          .u = part.mean,
          .w = ParamVector::Zero(dim_),
          .uu = part.covariance,
          .uw = ParamMatrix::Zero(dim_, dim_),
          .ww = FirstVelocity(law)};
}

Drift::Moments Drift::StoppedDrift(double within_s) noexcept {
  Moments stopped = MomentsOf(predicted_, Part::kDrift);
  const double g = std::fmin(within_s, 1.0 / kSwitching);
  if (!(g > 0.0) || !(stopped.weight > 0.0)) return stopped;
  const ParamVector variance = stopped.covariance.diagonal();
  for (std::size_t k = 0; k < predicted_.size(); ++k) {
    if (!IsOf(Part::kDrift, k)) continue;
    const Filter& f = predicted_[k];
    Filter& moved = work_[k];
    moved.weight = f.weight;
    if (!(f.weight > 0.0)) continue;
    moved.u = f.u + 0.5 * g * f.w;
    moved.uu = f.uu;
    for (int i = 0; i < dim_; ++i)
      for (int j = 0; j < dim_; ++j)
        moved.uu(i, j) += 0.5 * g * (f.uw(i, j) + f.uw(j, i)) + g * g * (f.ww(i, j) / 3.0 + f.w[i] * f.w[j] / 12.0);
  }
  stopped = MomentsOf(work_, Part::kDrift);
  for (int i = 0; i < dim_; ++i) {
    const double kept = KeptShare(variance[i], stopped.covariance(i, i));
    stopped.mean[i] *= kept;
    stopped.covariance.row(i) *= std::sqrt(kept);
    stopped.covariance.col(i) *= std::sqrt(kept);
  }
  return stopped;
}

void Drift::AddNewcomers(double elapsed_s, double gap_s) noexcept {
  const double switched = -std::expm1(-kSwitching * elapsed_s);
  const double from_rest = switched * (1.0 - hypotheses_[0].prior);
  const Moments rest = MomentsOf(predicted_, Part::kRest);
  const Moments drift = StoppedDrift(gap_s);
  for (std::size_t i = 0; i < predicted_.size(); ++i)
    predicted_[i].weight *= 1.0 - (IsOf(Part::kRest, i) ? from_rest : switched);
  for (std::size_t h = 0; h < static_cast<std::size_t>(NumHypotheses(dim_)); ++h) {
    const Hypothesis& law = hypotheses_[h];
    // What rests and goes on resting has not begun anew.
    Filter& begun = predicted_[kBegun * kHypotheses + h];
    if (h > 0 && rest.weight > 0.0) begun = Newcomer(rest, switched * law.prior, law);
    if (!(drift.weight > 0.0)) continue;
    Filter turned = Newcomer(drift, switched * law.prior, law);
    begun.Absorb(&turned);
  }
}

void Drift::TurnDrifts(double elapsed_s) noexcept {
  const double switched = -std::expm1(-kSwitching * elapsed_s);
  const Moments drift = MomentsOf(predicted_, Part::kDrift);
  if (!(drift.weight > 0.0)) return;
  for (std::size_t i = 0; i < predicted_.size(); ++i)
    if (IsOf(Part::kDrift, i)) predicted_[i].weight *= 1.0 - switched;
  const double any = 1.0 - hypotheses_[0].prior;
  for (std::size_t h = 1; h < static_cast<std::size_t>(NumHypotheses(dim_)); ++h)
    predicted_[kBegun * kHypotheses + h] = Newcomer(drift, switched * hypotheses_[h].prior / any, hypotheses_[h]);
}

void Drift::AddChanged(double share) noexcept {
  // Of draws with a noise scale of their own, the expansion cannot tell which are of a change (FindEnd).
  if (!started_ || share_ < kNegligible || !(share > 0.0) || space_.samples_noise_scale()) return;
  for (std::size_t h = 0; h < static_cast<std::size_t>(NumHypotheses(dim_)); ++h) {
    Filter& changed = predicted_[kChanged * kHypotheses + h];
    changed.weight = 0.0;
    for (std::size_t slot = kBegun; slot < kSlots; ++slot) {
      Filter& kept = predicted_[slot * kHypotheses + h];
      Filter also = kept;
      also.weight *= share;
      kept.weight *= 1.0 - share;
      changed.Absorb(&also);
    }
    if (!(changed.weight > 0.0)) continue;
    // (v, w) of u and w that are independent.
    const ParamMatrix with_w = Product(lead_, changed.ww);
    changed.u = -Multiply(lead_, changed.w);
    changed.uw = -with_w;
    changed.uu = Product(with_w, lead_.transpose());
    for (int d = 0; d < dim_; ++d) {
      const double sd = space_.prior_sd[static_cast<std::size_t>(d)];
      changed.uu(d, d) += sd * sd;
    }
  }
}

void Drift::Predict(double elapsed_s, double gap_s) noexcept {
  predicted_ = bank_;
  const double changes = std::fmin(std::ceil(kSwitching * elapsed_s), kMostSteps);
  const int steps = std::max(static_cast<int>(changes), 1);
  for (int step = 0; step < steps; ++step) {
    MakeRoom(&predicted_);
    if (step == 0) {
      AddNewcomers(elapsed_s, gap_s);
    } else {
      TurnDrifts(elapsed_s / steps);
    }
    for (std::size_t h = 1; h < static_cast<std::size_t>(NumHypotheses(dim_)); ++h) {
      const DriftStep after = hypotheses_[h].Step(elapsed_s / steps);
      const MovingParameters moving = hypotheses_[h].Moving(dim_);
      for (std::size_t i = h; i < predicted_.size(); i += kHypotheses)
        if (predicted_[i].weight > 0.0) predicted_[i].Propagate(after, moving);
    }
  }
}

void Drift::ExpectDrift() noexcept {
  double total = 0.0;
  double drifts = 0.0;
  rate_.fill(0.0);
  for (std::size_t i = 0; i < predicted_.size(); ++i) {
    total += predicted_[i].weight;
    if (IsOf(Part::kDrift, i)) drifts += predicted_[i].weight;
    const Hypothesis& law = hypotheses_[HypothesisOf(i)];
    for (int d = 0; d < dim_; ++d)
      rate_[static_cast<std::size_t>(d)] += law.Moves(d) ? predicted_[i].weight * law.rate : 0.0;
  }
  share_ = drifts / total;
  for (double& rate : rate_) rate /= total;
}

void Drift::ExpectVelocity() noexcept {
  work_ = predicted_;
  for (Filter& f : work_) {
    if (!(f.weight > 0.0)) continue;
    f.u = f.w;
    f.uu = f.ww;
  }
  const Moments velocity = MomentsOf(work_, Part::kWhole);
  velocity_ = {velocity.mean, velocity.covariance};
}

void Drift::Widening(double time_s, const PosteriorMemory& last, std::array<double, kMaxParams>* ratio) noexcept {
  ratio->fill(1.0);
  const double since = time_s - time_s_;
  if (!started_ || !last.valid || !(since > 0.0)) return;
  Predict(since, since);
  ExpectDrift();
  if (share_ < kNegligible) return;
  const Moments then = MomentsOf(bank_, Part::kWhole);
  const Moments now = MomentsOf(predicted_, Part::kWhole);
  for (int d = 0; d < dim_; ++d) {
    const double moved = now.mean[d] - then.mean[d];
    (*ratio)[static_cast<std::size_t>(d)] =
        std::sqrt(std::fmax((now.covariance(d, d) + moved * moved) / then.covariance(d, d), 1.0));
  }
}

}  // namespace armcmc
