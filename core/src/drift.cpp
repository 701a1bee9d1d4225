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

}  // namespace

Drift::Hypothesis Drift::Of(int h, double share, int dim) noexcept {
  if (h == 0) return {.rate = 0.0, .persistence = 1.0, .prior = 1.0 - share};
  const bool alone = h >= kFirstAlone;
  const Law& law = alone ? kAlone : kTogether[static_cast<std::size_t>(h - 1)];
  return {.rate = law.rate,
          .persistence = law.persistence,
          .prior = share / (NumHypotheses(dim) - 1),
          .alone = alone ? h - kFirstAlone : -1};
}

MovingParameters Drift::Hypothesis::Moving(int dim) const noexcept {
  if (rate == 0.0) return {};
  return alone < 0 ? MovingParameters{.first = 0, .count = dim} : MovingParameters{.first = alone, .count = 1};
}

DriftStep Drift::Hypothesis::Step(double elapsed_s) const noexcept {
  const double phi = std::exp(-elapsed_s / persistence);
  const double b = persistence * (1.0 - phi);
  const double speed = rate * rate;
  return {.phi = phi,
          .b = b,
          .noise_uu = std::fmax(speed * persistence * (2.0 * (elapsed_s - b) - b * (1.0 - phi)), 0.0),
          .noise_uw = speed * persistence * (1.0 - phi) * (1.0 - phi),
          .noise_ww = speed * (1.0 - phi * phi)};
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

bool Drift::Place(const DensityBlock& source, const ParamMatrix& map, const ParamVector& from,
                  const ParamVector& centre, int to) noexcept {
  const ParamMatrix inverse = Inverse(map);
  const double determinant = std::fabs(Determinant(map));
  if (!inverse.allFinite() || !(determinant > 0.0)) return false;
  DensityBlock& moved = carried_.block[static_cast<std::size_t>(to)];
  moved = source;
  moved.axis_aligned = false;
  // W' = W A^-1, and A W^-1 for its inverse; the noise scale is unchanged.
  for (int i = 0; i < dim_; ++i) {
    const auto ii = static_cast<std::size_t>(i);
    moved.mean[ii] = centre[i];
    for (int j = 0; j < dim_; ++j) moved.mean[ii] += map(i, j) * (source.mean[static_cast<std::size_t>(j)] - from[j]);
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

bool Drift::Move(const PosteriorMemory& last, Part part, const Moments& from, int block, int to) noexcept {
  const Moments target = MomentsOf(predicted_, part);
  ParamMatrix map;
  if (!MapBetween(from.covariance, target.covariance, &map)) return false;
  const DensityBlock& source = last.block[static_cast<std::size_t>(block)];
  if (part == Part::kDrift && source.dim == 1) {
    Mix(target, to);
    mixed_ = true;
    return true;
  }
  if (part == Part::kDrift && source.dim == dim_) {
    // Without the shape of the draws: under a heavy-tailed one the posterior would be narrower than that of the bank.
    SetElliptic(target.mean, target.covariance, 1.0, &normal_table_, &carried_.block[static_cast<std::size_t>(to)]);
    return true;
  }
  return Place(source, map, from.mean, target.mean, to);
}

bool Drift::MoveChanged(const PosteriorMemory& last, const Moments& from, int to) noexcept {
  const Moments target = MomentsOf(predicted_, Part::kWhole);
  const DensityBlock& source = last.block[1];
  const ParamVector mean = MeanOf(source).head(dim_);
  const ParamMatrix covariance = CovarianceOf(source).topLeftCorner(dim_, dim_);
  ParamMatrix wider = covariance;
  for (int d = 0; d < dim_; ++d) wider(d, d) += std::fmax(target.covariance(d, d) - from.covariance(d, d), 0.0);
  ParamMatrix map;
  return MapBetween(covariance, wider, &map) && Place(source, map, mean, mean + target.mean - from.mean, to);
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
  p_drifted_ = -1.0;
  rate_.fill(0.0);
  if (!last.valid) started_ = false;
  if (!started_) return last;
  // If the plant's time restarts, the elapsed time is unknown: at least one pack.
  const double since = data.time_s - time_s_;
  elapsed_s_ = since > 0.0 ? since : data.duration_s;
  const double gap = elapsed_s_ - data.duration_s;
  gap_s_ = gap > 0.5 * data.interval_s ? gap : 0.0;
  Predict(elapsed_s_, gap_s_);
  ExpectDrift();
  const Moments expected = MomentsOf(predicted_, Part::kWhole);
  expected_ = {expected.mean, expected.covariance};
  moves_ = share_ >= kNegligible || fitted_ != Part::kRest || both_;
  if (moves_) {
    expects_drift_ = share_ >= kNegligible;
    ExpectVelocity();
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
  if (rests && fitted_ == Part::kRest && !both_) {
    if (last.num_blocks != 1) return last;
    if (!Move(last, Part::kRest, from, 0, 0) || !SetMoments(last, Part::kRest, from)) return last;
    return carried_;
  }
  const int rest_from = both_ && fitted_ == Part::kDrift ? 1 : 0;
  const int drift_from = both_ && fitted_ == Part::kRest ? 1 : 0;
  const auto block_moments = [&](int b) noexcept ARMCMC_NONBLOCKING {
    if (b == 0) return Moments{.weight = from.weight, .mean = from.mean, .covariance = from.covariance};
    const DensityBlock& block = last.block[static_cast<std::size_t>(b)];
    return Moments{
        .weight = 1.0, .mean = MeanOf(block).head(dim_), .covariance = CovarianceOf(block).topLeftCorner(dim_, dim_)};
  };
  if (!rests && share_ < 1.0 - kNegligible) {
    // The more probable one first, and what may have changed last.
    const bool changed = last.num_blocks == 2 && !both_;
    drifting_block_ = share_ > 0.5 ? 0 : 1;
    if (!Move(last, Part::kDrift, block_moments(drift_from), drift_from, drifting_block_) ||
        !Move(last, Part::kRest, block_moments(rest_from), rest_from, 1 - drifting_block_) ||
        (changed && !MoveChanged(last, from, 2)) || !SetMoments(last, Part::kWhole, from))
      return last;
    const double kept = changed ? last.weight[0] : 1.0;
    carried_.num_blocks = changed ? 3 : 2;
    carried_.weight = {kept * std::fmax(share_, 1.0 - share_), kept * std::fmin(share_, 1.0 - share_), 1.0 - kept};
    split_ = true;
    return carried_;
  }
  if (both_) {
    const Part part = CarriedPart();
    const int block = part == Part::kDrift ? drift_from : rest_from;
    const Moments own = block_moments(block);
    if (!Move(last, part, own, block, 0)) return last;
    carried_.num_blocks = 1;
    carried_.weight = {1.0};
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

}  // namespace armcmc
