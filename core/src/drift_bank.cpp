// The bank of filters between packs: generations, newcomers, time.
#include <cmath>

#include "armcmc/drift.hpp"

namespace armcmc {

Drift::Moments Drift::MomentsOf(const Bank& bank, Part part) noexcept {
  const Eigen::Index dim = bank.back().u.size();
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

Drift::Filter Drift::JointOf(const Bank& bank, Part part) noexcept {
  Filter joint;
  for (std::size_t i = 0; i < bank.size(); ++i) {
    if (!IsOf(part, i) || !(bank[i].weight > 0.0)) continue;
    Filter f = bank[i];
    Merge(&f, &joint);
  }
  return joint;
}

void Drift::GrowOlder() noexcept {
  // From the oldest on, so that none moves by two generations.
  for (std::size_t g = kMergeAfter.size(); g-- > 0;) {
    if (packs_ % kMergeAfter[g] != 0) continue;
    for (std::size_t h = 0; h < kHypotheses; ++h)
      Merge(&predicted_[g * kHypotheses + h], &predicted_[(g + 1) * kHypotheses + h]);
  }
}

void Drift::AddNewcomers(double elapsed_s) noexcept {
  const Moments all = MomentsOf(predicted_, Part::kWhole);
  const Moments drifting = MomentsOf(predicted_, Part::kDrift);
  const double drift_share = 1.0 - hypotheses_[0].prior;
  const double kept = std::exp(-kSwitching * elapsed_s);
  const double none_began = std::exp(-kSwitching * elapsed_s * drift_share);
  const double straight = std::exp(-kTurning * elapsed_s);
  for (std::size_t i = 0; i < predicted_.size(); ++i)
    predicted_[i].weight *= IsOf(Part::kDrift, i) ? kept * straight : kept;
  for (std::size_t h = 0; h < kHypotheses; ++h) {
    const auto add = [&](double weight, const Moments& from) noexcept ARMCMC_NONBLOCKING {
      Filter fresh{.weight = weight,
                   .u = from.mean,
                   .w = ParamVector::Zero(dim_),
                   .uu = from.covariance,
                   .uw = ParamMatrix::Zero(dim_, dim_),
                   .ww = ParamMatrix::Identity(dim_, dim_)};
      fresh.ww *= hypotheses_[h].rate * hypotheses_[h].rate;
      Merge(&fresh, &predicted_[h]);
    };
    // Starts anywhere in the bank.
    const double share = h == 0 ? none_began - kept : (1.0 - none_began) * hypotheses_[h].prior / drift_share;
    add(share * all.weight, all);
    if (h > 0 && drifting.weight > 0.0)
      add(kept * (1.0 - straight) * hypotheses_[h].prior / drift_share * drifting.weight, drifting);
  }
}

void Drift::Propagate(double elapsed_s, Filter* filter) const noexcept {
  Filter& f = *filter;
  const ParamVector variance = f.uu.diagonal();
  f.u += elapsed_s * f.w;
  for (int i = 0; i < dim_; ++i)
    for (int j = 0; j <= i; ++j)
      f.uu(i, j) = f.uu(j, i) = f.uu(i, j) + elapsed_s * (f.uw(i, j) + f.uw(j, i)) + elapsed_s * elapsed_s * f.ww(i, j);
  for (int i = 0; i < dim_; ++i)
    for (int j = 0; j < dim_; ++j) f.uw(i, j) += elapsed_s * f.ww(i, j);
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
  GrowOlder();
  AddNewcomers(elapsed_s);
  for (std::size_t i = 0; i < predicted_.size(); ++i)
    if (predicted_[i].weight > 0.0 && HypothesisOf(i) > 0) Propagate(elapsed_s, &predicted_[i]);
}

void Drift::ExpectDrift() noexcept {
  double total = 0.0;
  double drifts = 0.0;
  rate_ = 0.0;
  for (std::size_t i = 0; i < predicted_.size(); ++i) {
    total += predicted_[i].weight;
    if (IsOf(Part::kDrift, i)) drifts += predicted_[i].weight;
    rate_ += predicted_[i].weight * hypotheses_[HypothesisOf(i)].rate;
  }
  share_ = drifts / total;
  rate_ /= total;
}

void Drift::Widening(double time_s, const PosteriorMemory& last, std::array<double, kMaxParams>* ratio) noexcept {
  ratio->fill(1.0);
  const double since = time_s - time_s_;
  if (!started_ || !last.valid || !(since > 0.0)) return;
  Predict(since);
  ExpectDrift();
  if (share_ < kNegligible) return;
  const Moments now = MomentsOf(predicted_, Part::kWhole);
  for (int d = 0; d < dim_; ++d) {
    const double moved = now.mean[d] - last.mean[d];
    (*ratio)[static_cast<std::size_t>(d)] =
        std::sqrt(std::fmax((now.covariance(d, d) + moved * moved) / last.covariance(d, d), 1.0));
  }
}

}  // namespace armcmc
