// What the bank learns from a pack.
#include <algorithm>
#include <array>
#include <cmath>

#include "armcmc/density_fit.hpp"
#include "armcmc/drift.hpp"
#include "armcmc/linear_algebra.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr double kEnoughDraws = 16.0;  // effective ones, for each number that they are to give
constexpr double kLikeness = 0.05;     // share of the effective draws that an expansion that is of use leaves
constexpr int kSearched = 256;         // draws, for one that is not improbable
constexpr double kChance = 3.0;        // times the square that chance makes, which is taken off a difference
constexpr double kExact = 1e-3;        // by what the effective draws of an expansion that is exact may differ
constexpr double kClear = 4.0;         // standard deviations from a bound that cuts nothing off
constexpr double kFar = 0.5;           // by more of them, the filters are wrong about a bound that does
constexpr int kMomentDraws = 4096;     // at most: their chance is small in a difference
constexpr double kForgotten = 1e-7;    // posterior probability of a change that the bank does not keep

}  // namespace

void Drift::Start(const PosteriorMemory& next, bool with_speeds) noexcept {
  for (std::size_t i = 0; i < bank_.size(); ++i) {
    Filter& f = bank_[i];
    if (with_speeds) {
      f = predicted_[i];
    } else {
      const Hypothesis& law = hypotheses_[HypothesisOf(i)];
      f.weight = i / kHypotheses + 1 == kSlots ? law.prior : 0.0;
      f.w = ParamVector::Zero(dim_);
      f.ww = FirstVelocity(law);
    }
    f.u = next.mean.head(dim_);
    f.uu = next.covariance.topLeftCorner(dim_, dim_);
    f.uw = ParamMatrix::Zero(dim_, dim_);
  }
}

Drift::Sampled Drift::SampledBlock(const ModeData& data, const PosteriorMemory& next, int block, Part part,
                                   LaplaceScratch* scratch) const noexcept {
  Sampled sampled{.part = part, .mean = {}, .covariance = {}, .local = {}};
  if (block == 0) {
    sampled.mean = next.mean.head(dim_);
    sampled.covariance = next.covariance.topLeftCorner(dim_, dim_);
  } else {
    const DensityBlock& other = next.block[static_cast<std::size_t>(block)];
    sampled.mean = MeanOf(other).head(dim_);
    sampled.covariance = CovarianceOf(other).topLeftCorner(dim_, dim_);
  }
  sampled.local = ExpandLikelihood(kernels_, model_, data, noise_, space_, sampled.mean, next.log_noise_scale, scratch);
  return sampled;
}

bool Drift::Update(const Sampled& sampled, Part part, double weight) noexcept {
  std::array<double, kFilters> log_weight{};
  double top = -HUGE_VAL;
  for (std::size_t i = 0; i < bank_.size(); ++i) {
    if (!IsOf(part, i)) continue;
    Filter& f = bank_[i];
    f = predicted_[i];
    if (!(f.weight > 0.0)) continue;
    log_weight[i] = std::log(f.weight) + f.MultiplyBy(sampled.local, sampled.mean);
    if (!std::isfinite(log_weight[i])) return false;
    top = std::fmax(top, log_weight[i]);
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < bank_.size(); ++i) {
    if (!IsOf(part, i)) continue;
    if (bank_[i].weight > 0.0) bank_[i].weight = std::exp(log_weight[i] - top);
    sum += bank_[i].weight;
  }
  for (std::size_t i = 0; i < bank_.size(); ++i) {
    if (!IsOf(part, i)) continue;
    bank_[i].weight *= weight / sum;
    if (SlotOf(i) == kChanged && bank_[i].weight < kForgotten) bank_[i].weight = 0.0;
  }
  return true;
}

Drift::Moments Drift::ByExpansion(const Sampled& sampled) const noexcept {
  // Of two posteriors, without and with a change, the memory has the moments of the bank, too.
  const bool as_the_bank =
      sampled.part == Part::kDrift ? mixed_ : (split_ || separate_) && sampled.part == Part::kWhole;
  if (as_the_bank) return MomentsOf(bank_, sampled.part);
  const LocalLikelihood& local = sampled.local;
  Moments now = MomentsOf(predicted_, sampled.part, kBegun);
  ParamMatrix spread = Product(local.information, now.covariance);
  spread += ParamMatrix::Identity(dim_, dim_);
  const ParamVector pulled = Multiply(local.information, now.mean - sampled.mean);
  now.covariance = Product(now.covariance, Inverse(spread));
  MakeSymmetric(&now.covariance);
  now.mean += Multiply(now.covariance, local.gradient - pulled);
  return now;
}

simd::QuadraticControl Drift::ControlOf(const Sampled& sampled, const Draws& draws) const noexcept {
  simd::QuadraticControl control{.dim = dim_};
  for (int i = 0; i < dim_; ++i) {
    control.centre[i] = sampled.mean[i];
    control.slope[i] = sampled.local.gradient[i];
    for (int j = 0; j <= i; ++j) control.curvature[i][j] = -(i == j ? 0.5 : 1.0) * sampled.local.information(i, j);
  }
  // The constant takes the difference out of one that counts.
  int best = 0;
  for (int k = 1; k < std::min(draws.count, kSearched); ++k)
    if (draws.weight[k] > draws.weight[best]) best = k;
  double at_best = 0.0;
  for (int i = 0; i < dim_; ++i) {
    const double z = draws.u[static_cast<std::size_t>(i)][best] - control.centre[i];
    double slope = control.slope[i];
    for (int j = 0; j <= i; ++j)
      slope += control.curvature[i][j] * (draws.u[static_cast<std::size_t>(j)][best] - control.centre[j]);
    at_best += slope * z;
  }
  control.constant = draws.log_likelihood[best] - at_best;
  return control;
}

void Drift::Draws::WeighInBank() const noexcept {
  if (!apart) {
    std::copy_n(weight, count, scratch);
    return;
  }
  const double constant = of_part ? 0.0 : 1.0;
  const double slope = of_part ? 1.0 : -1.0;
  for (int k = 0; k < count; ++k) scratch[k] = weight[k] * (constant + slope * share[k]);
}

double Drift::Tilt(const Sampled& sampled, const Draws& draws, int count) const noexcept {
  const auto effective = [&]() noexcept ARMCMC_NONBLOCKING {
    std::array<double, 2> sums{};
    kernels_.first_moments(0, nullptr, draws.scratch, count, sums.data());
    return sums[0] * sums[0] / sums[1];
  };
  const double before = effective();
  kernels_.tilt(ControlOf(sampled, draws), draws.u.data(), draws.log_likelihood, count, draws.scratch);
  const double after = effective();
  return after > kEnoughDraws * (dim_ + 1) ? after / before : 0.0;
}

Drift::Moments Drift::MomentsOfDraws(const Draws& draws, int count) const noexcept {
  Moments m{.weight = 0.0, .mean = ParamVector(dim_), .covariance = ParamMatrix(dim_, dim_)};
  std::array<double, 2 + kMaxParams> first{};
  kernels_.first_moments(dim_, draws.u.data(), draws.scratch, count, first.data());
  m.weight = first[0] * first[0] / first[1];
  for (int d = 0; d < dim_; ++d) m.mean[d] = first[static_cast<std::size_t>(2 + d)] / first[0];
  std::array<double, kMaxParams*(kMaxParams + 1) / 2> second{};
  kernels_.second_moments(dim_, draws.u.data(), draws.scratch, m.mean.data(), count, second.data());
  for (int i = 0, k = 0; i < dim_; ++i)
    for (int j = 0; j <= i; ++j, ++k)
      m.covariance(i, j) = m.covariance(j, i) = second[static_cast<std::size_t>(k)] / first[0];
  return m;
}

bool Drift::IsClearOfBounds(const Moments& moments) const noexcept {
  bool clear = true;
  for (int d = 0; d < dim_; ++d) {
    const auto i = static_cast<std::size_t>(d);
    const double reach = kClear * std::sqrt(moments.covariance(d, d));
    clear = clear && moments.mean[d] - reach > space_.lower[i] && moments.mean[d] + reach < space_.upper[i];
  }
  return clear;
}

bool Drift::TargetByDraws(const Sampled& sampled, const Draws& draws, const Moments& closed,
                          Moments* target) const noexcept {
  // The expansion is in the parameters alone.
  if (draws.share == nullptr || space_.samples_noise_scale()) return false;
  const int count = std::min(draws.count, kMomentDraws);
  const bool of_share = draws.of_part && sampled.part == draws.part;
  for (int k = 0; k < count; ++k)
    draws.scratch[k] = draws.weight[k] * (of_share ? draws.share[k] : 1.0 - draws.share[k]);
  const Moments actual = MomentsOfDraws(draws, count);
  const double likeness = Tilt(sampled, draws, count);
  if (!(likeness > kLikeness)) return false;
  const Moments expanded = MomentsOfDraws(draws, count);
  // By what the draws under the expansion differ from the filters: chance, or a prior that is no Gaussian. A share of
  // it is taken for real, as in James and Stein's estimator (positive part); none where the law is linear, for which
  // the filters know more than the densities that were sampled: those have the filters' moments, not their shape. They
  // do not know of a bound that cuts.
  ParamMatrix root;
  if (!CholeskyFactor(closed.covariance, &root)) return false;
  const ParamMatrix inverse = Inverse(root);
  const ParamVector apart = Multiply(inverse, expanded.mean - closed.mean);
  ParamMatrix wider = Product(Product(inverse, expanded.covariance), inverse.transpose());
  wider -= ParamMatrix::Identity(dim_, dim_);
  const double square = apart.squaredNorm() + 0.5 * wider.squaredNorm();
  const double by_chance = 0.5 * dim_ * (dim_ + 3) / expanded.weight;
  double kept = std::fmax(1.0 - kChance * by_chance / square, 0.0);
  if (std::fabs(likeness - 1.0) < kExact && (square < kFar * kFar || IsClearOfBounds(closed))) kept = 0.0;
  ParamMatrix map;
  if (!MapBetween(expanded.covariance, actual.covariance, &map)) return false;
  wider *= kept;
  wider += ParamMatrix::Identity(dim_, dim_);
  const ParamMatrix stretched = Product(map, root);
  target->mean = closed.mean + kept * Multiply(root, apart) + (actual.mean - expanded.mean);
  target->covariance = Product(Product(stretched, wider), stretched.transpose());
  MakeSymmetric(&target->covariance);
  return target->mean.allFinite();
}

bool Drift::Recentre(const Sampled& sampled, const Draws& draws) noexcept {
  const Moments closed = ByExpansion(sampled);
  Moments target;
  if (!TargetByDraws(sampled, draws, closed, &target)) {
    target.mean = sampled.mean;
    target.covariance = sampled.covariance;
  }
  ParamMatrix map;
  if (!MapBetween(closed.covariance, target.covariance, &map)) return false;
  for (std::size_t i = 0; i < bank_.size(); ++i) {
    Filter& f = bank_[i];
    if (f.weight > 0.0 && IsOf(sampled.part, i)) f.Transform(map, closed.mean, target.mean);
  }
  return true;
}

void Drift::SetShare(double p) noexcept {
  double drifts = 0.0;
  double rests = 0.0;
  for (std::size_t i = 0; i < bank_.size(); ++i) (IsOf(Part::kDrift, i) ? drifts : rests) += bank_[i].weight;
  for (std::size_t i = 0; i < bank_.size(); ++i)
    if (bank_[i].weight > 0.0) bank_[i].weight *= IsOf(Part::kDrift, i) ? p / drifts : (1.0 - p) / rests;
}

double Drift::CorrectedShare(const Draws& draws, bool tilted, double as_sampled) const noexcept {
  double p = 0.0;
  for (std::size_t i = 0; i < bank_.size(); ++i)
    if (IsOf(Part::kDrift, i)) p += bank_[i].weight;
  if (!split_ || !draws.of_part) return p;
  if (!tilted) return as_sampled;
  // By how much the odds of the same draws are not those under the expansion.
  const auto odds = [&](const double* weight) noexcept ARMCMC_NONBLOCKING {
    std::array<double, 3> sums{};
    kernels_.first_moments(1, &draws.share, weight, draws.count, sums.data());
    return sums[2] / (sums[0] - sums[2]);
  };
  const double ratio = odds(draws.weight) / odds(draws.scratch);
  if (!(ratio > 0.0) || !std::isfinite(ratio)) return as_sampled;
  const double corrected = draws.part == Part::kDrift ? ratio : 1.0 / ratio;
  return p * corrected / (p * corrected + 1.0 - p);
}

void Drift::Learn(const ModeData& data, const PosteriorMemory& next, const Draws& draws, Part part, bool both,
                  bool renewed, LaplaceScratch* scratch) noexcept {
  if (!enabled_ || !next.valid || !next.informed) return;
  UpdateBank(data, next, draws, part, both, renewed, scratch);
  MakeRoom(&bank_);  // now: the next pack waits for Carry(), but not for this
}

void Drift::UpdateBank(const ModeData& data, const PosteriorMemory& next, const Draws& draws, Part part, bool both,
                       bool renewed, LaplaceScratch* scratch) noexcept {
  time_s_ = data.time_s;
  fitted_ = part;
  both_ = false;
  separate_ = next.num_blocks == 2 && !both;
  const bool known = started_;
  started_ = true;
  if (known && !renewed) {
    const Sampled first = SampledBlock(data, next, 0, part, scratch);
    if (both) {
      // The linearised law of each is valid near its own mean.
      const Part other = part == Part::kRest ? Part::kDrift : Part::kRest;
      const Sampled second = SampledBlock(data, next, 1, other, scratch);
      const double of_part = p_drifted_ < 0.0 ? next.weight[0] : part == Part::kDrift ? p_drifted_ : 1.0 - p_drifted_;
      both_ = Update(first, part, of_part) && Update(second, other, 1.0 - of_part) && Recentre(first, draws) &&
              Recentre(second, draws);
      if (both_) return FromEffective();
    } else if (Update(first, Part::kWhole, 1.0)) {
      if (p_drifted_ >= 0.0) SetShare(p_drifted_);
      if (Recentre(first, draws)) return FromEffective();
    }
  }
  if (known && renewed) Predict(elapsed_s_, gap_s_);  // what this pack tells of velocities includes the change
  Start(next, known);
  if (known) FromEffective();
}

}  // namespace armcmc
