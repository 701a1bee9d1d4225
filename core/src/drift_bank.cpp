// The bank of filters between packs: generations, newcomers, time.
#include <algorithm>
#include <array>
#include <cmath>

#include "armcmc/drift.hpp"
#include "armcmc/linear_algebra.hpp"

namespace armcmc {
namespace {

/// Share of a variance that is kept, so that it does not grow beyond that of P_0.
double KeptShare(double before, double grown) noexcept ARMCMC_NONBLOCKING {
  return std::fmin(std::fmax(before, 1.0) / grown, 1.0);
}

}  // namespace

Drift::Moments Drift::MomentsOf(const Bank& bank, Part part, std::size_t first) const noexcept {
  Moments m{.weight = 0.0, .mean = ParamVector::Zero(dim_), .covariance = ParamMatrix::Zero(dim_, dim_)};
  for (std::size_t i = first * kHypotheses; i < bank.size(); ++i) {
    if (!IsOf(part, i) || !(bank[i].weight > 0.0)) continue;
    m.weight += bank[i].weight;
    m.mean += bank[i].weight * bank[i].u;
  }
  m.mean /= m.weight;
  for (std::size_t f = first * kHypotheses; f < bank.size(); ++f) {
    if (!IsOf(part, f) || !(bank[f].weight > 0.0)) continue;
    const ParamVector apart = bank[f].u - m.mean;
    const double share = bank[f].weight / m.weight;
    for (int i = 0; i < dim_; ++i)
      for (int j = 0; j < dim_; ++j) m.covariance(i, j) += share * (bank[f].uu(i, j) + apart[i] * apart[j]);
  }
  return m;
}

void Drift::Merge(Filter* from, Filter* to) noexcept {
  const double whole = from->weight + to->weight;
  if (to->weight > 0.0 && from->weight > 0.0) {
    const double p = to->weight / whole;
    const double q = 1.0 - p;
    const ParamVector apart = from->u - to->u;
    const ParamVector faster = from->w - to->w;
    const Eigen::Index dim = apart.size();
    for (Eigen::Index i = 0; i < dim; ++i)
      for (Eigen::Index j = 0; j < dim; ++j) {
        to->uu(i, j) = p * to->uu(i, j) + q * from->uu(i, j) + p * q * apart[i] * apart[j];
        to->uw(i, j) = p * to->uw(i, j) + q * from->uw(i, j) + p * q * apart[i] * faster[j];
        to->ww(i, j) = p * to->ww(i, j) + q * from->ww(i, j) + p * q * faster[i] * faster[j];
      }
    to->u += q * apart;
    to->w += q * faster;
  } else if (from->weight > 0.0) {
    *to = *from;
  }
  to->weight = whole;
  from->weight = 0.0;
}

double Drift::LogVolume(const Hypothesis& law, const Filter& f) const noexcept {
  std::array<Eigen::Index, kMaxParams> moving{};
  Eigen::Index count = 0;
  for (Eigen::Index d = 0; d < dim_; ++d)
    if (law.rate > 0.0 && law.Moves(d)) moving[static_cast<std::size_t>(count++)] = d;
  JointMatrix joint(dim_ + count, dim_ + count);
  joint.topLeftCorner(dim_, dim_) = f.uu;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index row = moving[static_cast<std::size_t>(i)];
    for (Eigen::Index d = 0; d < dim_; ++d) joint(dim_ + i, d) = f.uw(d, row);
    for (Eigen::Index j = 0; j <= i; ++j) joint(dim_ + i, dim_ + j) = f.ww(row, moving[static_cast<std::size_t>(j)]);
  }
  return 0.5 * LogDeterminant(joint);
}

void Drift::MakeRoom(Bank* bank) const noexcept {
  for (std::size_t h = 0; h < static_cast<std::size_t>(NumHypotheses(dim_)); ++h) {
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
    while (first < kNewcomers) {
      std::array<double, kSlots> volume{};
      for (std::size_t k = first; k < kSlots; ++k) volume[k] = slot(k).weight * LogVolume(hypotheses_[h], slot(k));
      double least = HUGE_VAL;
      std::size_t merged = first;
      for (std::size_t k = first; k + 1 < kSlots; ++k) {
        Filter later = slot(k);
        Filter both = slot(k + 1);
        Merge(&later, &both);
        const double lost = both.weight * LogVolume(hypotheses_[h], both) - volume[k] - volume[k + 1];
        if (!(lost < least)) continue;
        least = lost;
        merged = k;
      }
      Merge(&slot(merged), &slot(merged + 1));
      for (std::size_t k = merged; k > first; --k) slot(k) = slot(k - 1);
      slot(first++).weight = 0.0;
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
    Merge(&turned, &begun);
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
      Merge(&also, &changed);
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

void Drift::Propagate(const Hypothesis& law, double elapsed_s, Filter* filter) const noexcept {
  Filter& f = *filter;
  const double speed = law.rate * law.rate;
  const double t = law.persistence;
  const double phi = std::exp(-elapsed_s / t);
  const double b = t * (1.0 - phi);
  const double noise_w = speed * (1.0 - phi * phi);
  const double noise_uw = speed * t * (1.0 - phi) * (1.0 - phi);
  const double noise_u = std::fmax(speed * t * (2.0 * (elapsed_s - b) - b * (1.0 - phi)), 0.0);
  const ParamVector variance = f.uu.diagonal();
  f.u += b * f.w;
  for (int i = 0; i < dim_; ++i)
    for (int j = 0; j <= i; ++j)
      f.uu(i, j) = f.uu(j, i) =
          f.uu(i, j) + b * (f.uw(i, j) + f.uw(j, i)) + b * b * f.ww(i, j) + (i == j && law.Moves(i) ? noise_u : 0.0);
  for (int i = 0; i < dim_; ++i)
    for (int j = 0; j < dim_; ++j)
      f.uw(i, j) = phi * (f.uw(i, j) + b * f.ww(i, j)) + (i == j && law.Moves(i) ? noise_uw : 0.0);
  f.w *= phi;
  f.ww *= phi * phi;
  for (int i = 0; i < dim_; ++i) f.ww(i, i) += law.Moves(i) ? noise_w : 0.0;
  for (int i = 0; i < dim_; ++i) {
    const double kept = KeptShare(variance[i], f.uu(i, i));
    const double shrink = std::sqrt(kept);
    f.u[i] *= kept;
    f.uu.row(i) *= shrink;
    f.uu.col(i) *= shrink;
    f.uw.row(i) *= shrink;
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
    for (std::size_t i = 0; i < predicted_.size(); ++i)
      if (predicted_[i].weight > 0.0 && HypothesisOf(i) > 0)
        Propagate(hypotheses_[HypothesisOf(i)], elapsed_s / steps, &predicted_[i]);
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
