#include "armcmc/drift.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "armcmc/density_fit.hpp"
#include "armcmc/linear_algebra.hpp"
#include "armcmc/prefetch.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr double kMixedReach = 6.0;  // standard deviations
constexpr double kMixedTail = 1e-3;  // of a normal law in a mixture
constexpr double kLeftOut = 1e-5;    // share below which a filter is left out of the mixture

void MakeSymmetric(ParamMatrix* m) noexcept {
  for (Eigen::Index i = 0; i < m->rows(); ++i)
    for (Eigen::Index j = 0; j < i; ++j) (*m)(i, j) = (*m)(j, i) = 0.5 * ((*m)(i, j) + (*m)(j, i));
}

/// A with A C A' = R. @return false if C or R is not a covariance.
bool MapBetween(const ParamMatrix& c, const ParamMatrix& r, ParamMatrix* a) noexcept {
  ParamMatrix root;
  if (!c.allFinite() || !r.allFinite() || !CholeskyFactor(c, &root)) return false;
  const ParamMatrix inverse = Inverse(root);
  ParamMatrix relative = Product(Product(inverse, r), inverse.transpose());
  MakeSymmetric(&relative);
  const SymmetricEigen eigen = EigenOfSymmetric(relative);
  if (!eigen.converged || !(eigen.values[0] > 0.0)) return false;
  ParamMatrix stretched = eigen.vectors;
  for (Eigen::Index i = 0; i < stretched.cols(); ++i) stretched.col(i) *= std::sqrt(eigen.values[i]);
  *a = Product(Product(root, Product(stretched, eigen.vectors.transpose())), inverse);
  return a->allFinite();
}

}  // namespace

Drift::Hypothesis Drift::Of(int h, double share, int dim) noexcept {
  if (h == 0) return {.rate = 0.0, .persistence = 1.0, .prior = 1.0 - share};
  double all_odds = 0.0;
  for (int i = 1; i < NumHypotheses(dim); ++i) all_odds += LawOf(i).odds;
  const Law& law = LawOf(h);
  return {.rate = law.rate,
          .persistence = law.persistence,
          .prior = share * law.odds / all_odds,
          .alone = h >= kFirstAlone ? h - kFirstAlone : -1};
}

Drift::Drift(const simd::Kernels& kernels, int model, const ParameterSpace& space, const NoiseModel& noise,
             double share, std::shared_ptr<Scratch> scratch)
    : kernels_(kernels),
      model_(model),
      space_(space),
      noise_(noise),
      normal_table_(MarginalTable::Normal()),
      dim_(space.num_parameters),
      enabled_(share > 0.0),
      scratch_(std::move(scratch)),
      predicted_(scratch_->predicted_),
      work_(scratch_->work_),
      lead_(ParamMatrix::Zero(dim_, dim_)) {
  for (int h = 0; h < NumHypotheses(dim_); ++h) hypotheses_[static_cast<std::size_t>(h)] = Of(h, share, dim_);
}

std::shared_ptr<Drift::Scratch> Drift::MakeScratch() { return std::make_shared<Scratch>(); }

void Drift::Prefetch() const noexcept {
  if (!started_) return;
  for (std::size_t i = 0; i < bank_.size(); ++i)
    if (Exists(i)) armcmc::Prefetch(&bank_[i], sizeof bank_[i]);
}

void Drift::Forget() noexcept {
  started_ = split_ = mixed_ = both_ = false;
  share_ = 0.0;
  rate_.fill(0.0);
}

void Drift::Mix(const Moments& part, int to) noexcept {
  const auto b = static_cast<std::size_t>(to);
  MarginalTable& table = carried_.tables[b][0];
  DensityBlock& block = carried_.block[b];
  constexpr int kNodes = 2 * static_cast<int>(kMixedReach * MarginalTable::kNodesPerUnit) + 1;
  std::array<double, kNodes> values{};
  const double sd = std::sqrt(part.covariance(0, 0));
  const auto add = [&](double share, double mean, double spread) noexcept ARMCMC_NONBLOCKING {
    const double per_sd = 1.0 / std::fmax(spread, 1.0 / MarginalTable::kNodesPerUnit);
    for (int n = 0; n < kNodes; ++n) {
      const double z = (n / MarginalTable::kNodesPerUnit - kMixedReach - mean) * per_sd;
      values[static_cast<std::size_t>(n)] += share * per_sd * std::exp(-0.5 * z * z);
    }
  };
  add(kMixedTail, 0.0, 1.0);
  for (std::size_t i = 0; i < predicted_.size(); ++i) {
    const Filter& f = predicted_[i];
    const double share = f.weight / part.weight;
    if (IsOf(Part::kDrift, i) && share > kLeftOut) add(share, (f.u[0] - part.mean[0]) / sd, std::sqrt(f.uu(0, 0)) / sd);
  }
  table.Build(values.data(), kNodes, -kMixedReach);
  SetElliptic(part.mean, part.covariance, 1.0 / std::sqrt(table.Variance()), &table, &block);
  block.center[0] = -block.scale[0] * table.Mean();
}

bool Drift::Move(const PosteriorMemory& last, Part part, const Moments& from, int block, int to) noexcept {
  const Moments target = MomentsOf(predicted_, part);
  ParamMatrix map;
  if (!MapBetween(from.covariance, target.covariance, &map)) return false;
  const ParamMatrix inverse = Inverse(map);
  const double determinant = std::fabs(Determinant(map));
  if (!inverse.allFinite() || !(determinant > 0.0)) return false;
  const DensityBlock& source = last.block[static_cast<std::size_t>(block)];
  if (part == Part::kDrift && source.dim == 1) {
    Mix(target, to);
    mixed_ = true;
    return true;
  }
  DensityBlock& moved = carried_.block[static_cast<std::size_t>(to)];
  if (part == Part::kDrift && source.dim == dim_) {
    // Without the shape of the draws: under a heavy-tailed one the posterior would be narrower than that of the bank.
    SetElliptic(target.mean, target.covariance, 1.0, &normal_table_, &moved);
    return true;
  }
  moved = source;
  moved.axis_aligned = false;
  // W' = W A^-1, and A W^-1 for its inverse; the noise scale is unchanged.
  for (int i = 0; i < dim_; ++i) {
    const auto ii = static_cast<std::size_t>(i);
    moved.mean[ii] = target.mean[i];
    for (int j = 0; j < dim_; ++j)
      moved.mean[ii] += map(i, j) * (source.mean[static_cast<std::size_t>(j)] - from.mean[j]);
    for (std::size_t r = 0; r < static_cast<std::size_t>(source.dim); ++r) {
      double whiten = 0.0;
      double unwhiten = 0.0;
      for (int k = 0; k < dim_; ++k) {
        whiten += source.whiten[r][static_cast<std::size_t>(k)] * inverse(k, i);
        unwhiten += map(i, k) * source.unwhiten[static_cast<std::size_t>(k)][r];
      }
      moved.whiten[r][ii] = whiten;
      moved.unwhiten[ii][r] = unwhiten;
    }
  }
  moved.norm = source.norm / determinant;
  return std::isfinite(moved.norm);
}

bool Drift::SetMoments(const PosteriorMemory& last, Part part, const Moments& from) noexcept {
  const Moments target = MomentsOf(predicted_, part);
  ParamMatrix map;
  if (!MapBetween(from.covariance, target.covariance, &map)) return false;
  ParamMatrix whole_map = ParamMatrix::Identity(last.mean.size(), last.mean.size());
  whole_map.topLeftCorner(dim_, dim_) = map;
  carried_.covariance = Product(Product(whole_map, last.covariance), whole_map.transpose());
  MakeSymmetric(&carried_.covariance);
  carried_.mean = last.mean;
  carried_.mean.head(dim_) = target.mean + Multiply(map, last.mean.head(dim_) - from.mean);
  return IsPositiveDefinite(carried_.covariance);
}

Drift::Part Drift::CarriedPart() const noexcept {
  if (share_ < kNegligible) return Part::kRest;
  return share_ < 1.0 - kNegligible ? Part::kWhole : Part::kDrift;
}

const PosteriorMemory& Drift::Carry(const ModeData& data, const PosteriorMemory& last,
                                    LaplaceScratch* scratch) noexcept {
  split_ = mixed_ = moves_ = false;
  share_ = 0.0;
  rate_.fill(0.0);
  if (!last.valid) started_ = false;
  if (!started_) return last;
  // If the plant's time restarts, the elapsed time is unknown: at least one pack.
  const double since = data.time_s - time_s_;
  elapsed_s_ = since > 0.0 ? since : data.duration_s;
  Predict(elapsed_s_);
  ExpectDrift();
  const Moments expected = MomentsOf(predicted_, Part::kWhole);
  expected_ = {expected.mean, expected.covariance};
  moves_ = share_ >= kNegligible || fitted_ != Part::kRest || both_;
  if (moves_) {
    ToEffective(data, last, scratch);
    ExpectDrift();
  } else {
    StandStill();  // without a part in the prior of this pack: the fit would cost more than it tells
  }
  const Moments from{
      .weight = 1.0, .mean = last.mean.head(dim_), .covariance = last.covariance.topLeftCorner(dim_, dim_)};
  carried_.valid = true;
  carried_.informed = last.informed;
  carried_.log_noise_scale = last.log_noise_scale;
  carried_.weight = last.weight;
  carried_.num_blocks = last.num_blocks;
  const bool rests = share_ < kNegligible;
  if (rests && fitted_ == Part::kRest && !both_) return last;
  const int rest_from = both_ && fitted_ == Part::kDrift ? 1 : 0;
  const int drift_from = both_ && fitted_ == Part::kRest ? 1 : 0;
  const auto block_moments = [&](int b) noexcept ARMCMC_NONBLOCKING {
    if (b == 0) return Moments{.weight = from.weight, .mean = from.mean, .covariance = from.covariance};
    const DensityBlock& block = last.block[static_cast<std::size_t>(b)];
    return Moments{
        .weight = 1.0, .mean = MeanOf(block).head(dim_), .covariance = CovarianceOf(block).topLeftCorner(dim_, dim_)};
  };
  if ((both_ || last.num_blocks == 1) && !rests && share_ < 1.0 - kNegligible) {
    // The more probable one first.
    drifting_block_ = share_ > 0.5 ? 0 : 1;
    if (!Move(last, Part::kDrift, block_moments(drift_from), drift_from, drifting_block_) ||
        !Move(last, Part::kRest, block_moments(rest_from), rest_from, 1 - drifting_block_) ||
        !SetMoments(last, Part::kWhole, from))
      return last;
    carried_.num_blocks = 2;
    carried_.weight = {std::fmax(share_, 1.0 - share_), std::fmin(share_, 1.0 - share_)};
    split_ = true;
    return carried_;
  }
  if (both_) {
    const Part part = CarriedPart();
    const int block = part == Part::kDrift ? drift_from : rest_from;
    const Moments own = block_moments(block);
    if (!Move(last, part, own, block, 0)) return last;
    carried_.num_blocks = 1;
    carried_.weight = {1.0, 0.0};
    carried_.mean = MeanOf(carried_.block[0]);
    carried_.covariance = CovarianceOf(carried_.block[0]);
    return carried_;
  }
  // Two posteriors, one with constant parameters and one with some changed, remain separate.
  const Part part = CarriedPart();
  for (int b = 0; b < last.num_blocks; ++b)
    if (!Move(last, part, from, b, b)) return last;
  return SetMoments(last, part, from) ? carried_ : last;
}

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
  const LocalLikelihood& local = sampled.local;
  const ParamMatrix identity = ParamMatrix::Identity(dim_, dim_);
  std::array<double, kFilters> log_weight{};
  double top = -HUGE_VAL;
  for (std::size_t i = 0; i < bank_.size(); ++i) {
    if (!IsOf(part, i)) continue;
    Filter& f = bank_[i];
    f = predicted_[i];
    if (!(f.weight > 0.0)) continue;
    // P = C (1 + H C)^-1, and w is updated through its covariance with u.
    ParamMatrix spread = Product(local.information, f.uu);
    spread += identity;
    const ParamMatrix t = Inverse(spread);
    const ParamVector apart = f.u - sampled.mean;
    const ParamVector pulled = Multiply(local.information, apart);
    const ParamVector residual = local.gradient - pulled;
    const ParamVector step = Multiply(t, residual);
    const ParamVector move = Multiply(f.uu, step);
    log_weight[i] = std::log(f.weight) + local.gradient.dot(apart) - 0.5 * apart.dot(pulled) +
                    0.5 * residual.dot(move) - 0.5 * std::log(std::fmax(Determinant(spread), 1e-300));
    if (!std::isfinite(log_weight[i])) return false;
    top = std::fmax(top, log_weight[i]);
    f.u += move;
    f.w += Multiply(f.uw.transpose(), step);
    f.ww -= Product(Product(f.uw.transpose(), Product(t, local.information)), f.uw);
    f.uw = Product(t.transpose(), f.uw);
    f.uu = Product(f.uu, t);
    MakeSymmetric(&f.uu);
    MakeSymmetric(&f.ww);
    if (!f.u.allFinite() || !f.w.allFinite() || !f.uu.allFinite() || !f.uw.allFinite() || !f.ww.allFinite())
      return false;
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

Drift::Moments Drift::ByExpansion(const Sampled& sampled) const noexcept {
  // Of two posteriors, without and with a change, the memory has the moments of the bank, too.
  const bool as_the_bank =
      sampled.part == Part::kDrift ? mixed_ : (split_ || separate_) && sampled.part == Part::kWhole;
  if (as_the_bank) return MomentsOf(bank_, sampled.part);
  const LocalLikelihood& local = sampled.local;
  Moments now = MomentsOf(predicted_, sampled.part);
  ParamMatrix spread = Product(local.information, now.covariance);
  spread += ParamMatrix::Identity(dim_, dim_);
  const ParamVector pulled = Multiply(local.information, now.mean - sampled.mean);
  now.covariance = Product(now.covariance, Inverse(spread));
  MakeSymmetric(&now.covariance);
  now.mean += Multiply(now.covariance, local.gradient - pulled);
  return now;
}

bool Drift::Recentre(const Sampled& sampled) noexcept {
  const Moments now = ByExpansion(sampled);
  ParamMatrix map;
  if (!MapBetween(now.covariance, sampled.covariance, &map)) return false;
  for (std::size_t i = 0; i < bank_.size(); ++i) {
    Filter& f = bank_[i];
    if (!(f.weight > 0.0) || !IsOf(sampled.part, i)) continue;
    f.u = sampled.mean + Multiply(map, f.u - now.mean);
    f.uu = Product(Product(map, f.uu), map.transpose());
    MakeSymmetric(&f.uu);
    f.uw = Product(map, f.uw);
  }
  return true;
}

void Drift::Learn(const ModeData& data, const PosteriorMemory& next, Part part, bool both, bool renewed,
                  LaplaceScratch* scratch) noexcept {
  if (!enabled_ || !next.valid || !next.informed) return;
  UpdateBank(data, next, part, both, renewed, scratch);
  MakeRoom(&bank_);  // now: the next pack waits for Carry(), but not for this
}

void Drift::UpdateBank(const ModeData& data, const PosteriorMemory& next, Part part, bool both, bool renewed,
                       LaplaceScratch* scratch) noexcept {
  time_s_ = data.time_s;
  fitted_ = part;
  both_ = false;
  separate_ = next.num_blocks == 2 && !both;
  const bool known = started_;
  started_ = true;
  if (known && !renewed) {
    const Sampled first = SampledBlock(data, next, 0, part, scratch);
    if (both) {
      // The linearised law of each is valid near its own mean; their probabilities were sampled.
      const Part other = part == Part::kRest ? Part::kDrift : Part::kRest;
      const Sampled second = SampledBlock(data, next, 1, other, scratch);
      both_ = Update(first, part, next.weight[0]) && Update(second, other, next.weight[1]) && Recentre(first) &&
              Recentre(second);
      if (both_) return FromEffective();
    } else if (Update(first, Part::kWhole, 1.0) && Recentre(first)) {
      return FromEffective();
    }
  }
  if (known && renewed) Predict(elapsed_s_);  // what this pack tells of velocities includes the change
  Start(next, known);
  if (known) FromEffective();
}

}  // namespace armcmc
