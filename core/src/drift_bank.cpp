// The bank of filters between packs: generations, newcomers, time.
#include <cmath>

#include "armcmc/drift.hpp"

namespace armcmc {

Drift::Moments Drift::MomentsOf(const Bank& bank, Part part) noexcept {
  const Eigen::Index dim = bank.front().u.size();
  Moments m{.weight = 0.0, .mean = ParamVector::Zero(dim), .covariance = ParamMatrix::Zero(dim, dim)};
  for (std::size_t i = 0; i < bank.size(); ++i) {
    if (!IsOf(part, i) || !(bank[i].weight > 0.0)) continue;
    m.weight += bank[i].weight;
    m.mean += bank[i].weight * bank[i].u;
  }
  m.mean /= m.weight;
  for (std::size_t f = 0; f < bank.size(); ++f) {
    if (!IsOf(part, f) || !(bank[f].weight > 0.0)) continue;
    const ParamVector apart = bank[f].u - m.mean;
    const double share = bank[f].weight / m.weight;
    for (Eigen::Index i = 0; i < dim; ++i)
      for (Eigen::Index j = 0; j < dim; ++j) m.covariance(i, j) += share * (bank[f].uu(i, j) + apart[i] * apart[j]);
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

void Drift::MergeOlderGenerations() noexcept {
  // From the oldest on, so that none moves by two generations.
  for (std::size_t g = kMergeAfter.size(); g-- > 0;) {
    if (packs_ % kMergeAfter[g] != 0) continue;
    for (std::size_t h = 0; h < kHypotheses; ++h)
      Merge(&predicted_[g * kHypotheses + h], &predicted_[(g + 1) * kHypotheses + h]);
  }
}

ParamMatrix Drift::FirstVelocity(const Hypothesis& law) const noexcept {
  ParamMatrix covariance = ParamMatrix::Zero(dim_, dim_);
  for (int d = 0; d < dim_; ++d) covariance(d, d) = law.Moves(d) ? law.rate * law.rate : 0.0;
  return covariance;
}

void Drift::AddFreshFilters(double share) noexcept {
  const Moments all = MomentsOf(predicted_, Part::kWhole);
  for (Filter& f : predicted_) f.weight *= 1.0 - share;
  // Starts anywhere in the bank, with a rate from the law of the hypothesis.
  for (std::size_t h = 0; h < static_cast<std::size_t>(NumHypotheses(dim_)); ++h) {
    Filter fresh{.weight = share * hypotheses_[h].prior * all.weight,
                 .u = all.mean,
                 .w = ParamVector::Zero(dim_),
                 .uu = all.covariance,
                 .uw = ParamMatrix::Zero(dim_, dim_),
                 .ww = FirstVelocity(hypotheses_[h])};
    Merge(&fresh, &predicted_[h]);
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
    for (int j = 0; j < dim_; ++j) f.uw(i, j) = phi * (f.uw(i, j) + b * f.ww(i, j)) + (i == j && law.Moves(i) ? noise_uw : 0.0);
  f.w *= phi;
  f.ww *= phi * phi;
  for (int i = 0; i < dim_; ++i) f.ww(i, i) += law.Moves(i) ? noise_w : 0.0;
  for (int i = 0; i < dim_; ++i) {
    const double kept = std::fmin(std::fmax(variance[i], 1.0) / f.uu(i, i), 1.0);
    const double shrink = std::sqrt(kept);
    f.u[i] *= kept;
    f.uu.row(i) *= shrink;
    f.uu.col(i) *= shrink;
    f.uw.row(i) *= shrink;
  }
}

void Drift::Predict(double elapsed_s) noexcept {
  predicted_ = bank_;
  MergeOlderGenerations();
  AddFreshFilters(1.0 - std::exp(-kSwitching * elapsed_s));
  for (std::size_t i = 0; i < predicted_.size(); ++i)
    if (predicted_[i].weight > 0.0 && HypothesisOf(i) > 0)
      Propagate(hypotheses_[HypothesisOf(i)], elapsed_s, &predicted_[i]);
}

void Drift::ExpectDrift() noexcept {
  double total = 0.0;
  double drifts = 0.0;
  rate_.fill(0.0);
  for (std::size_t i = 0; i < predicted_.size(); ++i) {
    total += predicted_[i].weight;
    if (IsOf(Part::kDrift, i)) drifts += predicted_[i].weight;
    const Hypothesis& law = hypotheses_[HypothesisOf(i)];
    for (int d = 0; d < dim_; ++d) rate_[static_cast<std::size_t>(d)] += law.Moves(d) ? predicted_[i].weight * law.rate : 0.0;
  }
  share_ = drifts / total;
  for (double& rate : rate_) rate /= total;
}

void Drift::Widening(double time_s, const PosteriorMemory& last, std::array<double, kMaxParams>* ratio) noexcept {
  ratio->fill(1.0);
  const double since = time_s - time_s_;
  if (!started_ || !last.valid || !(since > 0.0)) return;
  Predict(since);
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
