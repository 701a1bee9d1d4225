// The bank of filters between packs: merging, newcomers, time.
#include <array>
#include <cmath>

#include "armcmc/drift.hpp"

namespace armcmc {
namespace {

constexpr double kShortestGap = 1e-3;  // s: what is shorter is rounding of the time of a sample

}  // namespace

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

void Drift::MakeRoom() noexcept {
  for (std::size_t h = 0; h < kHypotheses; ++h) {
    const auto slot = [&](std::size_t k) noexcept -> Filter& { return predicted_[k * kHypotheses + h]; };
    if (!(slot(0).weight > 0.0)) continue;
    std::array<double, kSlots> entropy{};
    for (std::size_t k = 0; k < kSlots; ++k) entropy[k] = slot(k).weight * LogVolume(slot(k), h > 0);
    std::size_t closest = 0;
    double least = HUGE_VAL;
    for (std::size_t k = 0; k + 1 < kSlots; ++k) {
      Filter from = slot(k);
      Filter both = slot(k + 1);
      Merge(&from, &both);
      const double lost = both.weight * LogVolume(both, h > 0) - entropy[k] - entropy[k + 1];
      if (lost < least) {
        least = lost;
        closest = k;
      }
    }
    Merge(&slot(closest), &slot(closest + 1));
    for (std::size_t k = closest; k > 0; --k) slot(k) = slot(k - 1);
    slot(0).weight = 0.0;
  }
}

void Drift::AddNewcomers(double elapsed_s, double turned) noexcept {
  const Moments rest = MomentsOf(predicted_, Part::kRest);
  const Moments drift = MomentsOf(predicted_, Part::kDrift);
  const double drift_share = 1.0 - hypotheses_[0].prior;
  const double switched = -std::expm1(-kSwitching * elapsed_s);
  const double begins = switched * drift_share;
  const double ends = switched - begins;
  for (std::size_t i = 0; i < predicted_.size(); ++i)
    predicted_[i].weight *= IsOf(Part::kRest, i) ? 1.0 - begins : (1.0 - ends) * (1.0 - turned);
  for (std::size_t h = 0; h < kHypotheses; ++h) {
    const auto add = [&](const Moments& from, double share) noexcept ARMCMC_NONBLOCKING {
      if (!(share * from.weight > 0.0)) return;
      Filter fresh{.weight = share * from.weight,
                   .u = from.mean,
                   .w = ParamVector::Zero(dim_),
                   .uu = from.covariance,
                   .uw = ParamMatrix::Zero(dim_, dim_),
                   .ww = ParamMatrix::Identity(dim_, dim_)};
      fresh.ww *= hypotheses_[h].rate * hypotheses_[h].rate;
      Merge(&fresh, &predicted_[h]);
    };
    if (h == 0) {
      add(drift, ends);
      continue;
    }
    add(drift, (1.0 - ends) * turned * hypotheses_[h].prior / drift_share);
    add(rest, switched * hypotheses_[h].prior);
  }
}

void Drift::GoStraight(double elapsed_s, Filter* filter) const noexcept {
  Filter& f = *filter;
  const ParamVector variance = f.uu.diagonal();
  f.u += elapsed_s * f.w;
  for (int i = 0; i < dim_; ++i)
    for (int j = 0; j <= i; ++j)
      f.uu(i, j) = f.uu(j, i) = f.uu(i, j) + elapsed_s * (f.uw(i, j) + f.uw(j, i)) + elapsed_s * elapsed_s * f.ww(i, j);
  f.uw += elapsed_s * f.ww;
  KeepWithin(variance, &f);
}

void Drift::GoOnTurning(double rate, double elapsed_s, Filter* filter) const noexcept {
  Filter& f = *filter;
  const double x = kTurning * elapsed_s;
  const double lost = -std::expm1(-x);
  const double kept = 1.0 - lost;
  const double b = lost / kTurning;  // the mean path over the first velocity
  const double cross = elapsed_s * kept;
  // 2 / kappa_t^2 times (lost - x kept) and (x - lost) - (lost - x kept): differences of nearly equal numbers over
  // short times, there the first terms of their series.
  const double t2 = 2.0 * elapsed_s * elapsed_s;
  const double of_first = x < 0.01 ? t2 * (1.0 / 2.0 - x * (1.0 / 3.0 - x / 8.0)) : t2 / (x * x) * (lost - x * kept);
  const double of_later = x < 0.01 ? t2 * x * (1.0 / 6.0 - x / 12.0) : t2 / (x * x) * ((x - lost) - (lost - x * kept));
  const double speed = rate * rate;
  const ParamVector variance = f.uu.diagonal();
  for (int i = 0; i < dim_; ++i)
    for (int j = 0; j <= i; ++j)
      f.uu(i, j) = f.uu(j, i) = f.uu(i, j) + b * (f.uw(i, j) + f.uw(j, i)) + of_first * (f.ww(i, j) + f.w[i] * f.w[j]) -
                                b * b * f.w[i] * f.w[j] + (i == j ? of_later * speed : 0.0);
  for (int i = 0; i < dim_; ++i)
    for (int j = 0; j < dim_; ++j)
      f.uw(i, j) = kept * f.uw(i, j) + cross * f.ww(i, j) + (cross - b * kept) * f.w[i] * f.w[j] +
                   (i == j ? (b - cross) * speed : 0.0);
  for (int i = 0; i < dim_; ++i)
    for (int j = 0; j <= i; ++j)
      f.ww(i, j) = f.ww(j, i) = kept * (f.ww(i, j) + lost * f.w[i] * f.w[j]) + (i == j ? lost * speed : 0.0);
  f.u += b * f.w;
  f.w *= kept;
  KeepWithin(variance, &f);
}

void Drift::KeepWithin(const ParamVector& variance, Filter* filter) noexcept {
  Filter& f = *filter;
  for (Eigen::Index i = 0; i < variance.size(); ++i) {
    const double kept = std::fmin(std::fmax(variance[i], 1.0) / f.uu(i, i), 1.0);
    const double shrink = std::sqrt(kept);
    f.u[i] *= kept;
    f.uu.row(i) *= shrink;
    f.uu.col(i) *= shrink;
    f.uw.row(i) *= shrink;
  }
}

void Drift::Pass(double elapsed_s, bool recorded) noexcept {
  MakeRoom();
  AddNewcomers(elapsed_s, recorded ? -std::expm1(-kTurning * elapsed_s) : 0.0);
  for (std::size_t i = 0; i < predicted_.size(); ++i) {
    const double rate = hypotheses_[HypothesisOf(i)].rate;
    if (!(predicted_[i].weight > 0.0) || !(rate > 0.0)) continue;
    if (recorded) {
      GoStraight(elapsed_s, &predicted_[i]);
    } else {
      GoOnTurning(rate, elapsed_s, &predicted_[i]);
    }
  }
}

void Drift::Predict(double elapsed_s, double pack_s) noexcept {
  predicted_ = bank_;
  const double gap = elapsed_s - pack_s;
  if (gap > kShortestGap) Pass(gap, false);
  if (pack_s > 0.0) Pass(std::fmin(pack_s, elapsed_s), true);
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
  Predict(since, 0.0);
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
