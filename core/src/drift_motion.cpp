// Parameters that move within a pack, for a sampler that takes the parameters of a pack for constant.
#include <algorithm>
#include <array>
#include <cmath>

#include "armcmc/drift.hpp"
#include "armcmc/linear_algebra.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

/// Of the prior's precision in the inverse of H: H alone may have directions that the pack does not determine.
constexpr double kLeastPrecision = 1e-4;
/// Of P_0's: where a pack cannot tell a friction from an offset, v would be hundreds of its standard deviations away.
constexpr double kLeastOfInitial = 3e-3;
/// Share of the effective draws that an expansion that is of use leaves, for quantiles in the tails.
constexpr double kLikenessInTails = 0.5;
constexpr std::size_t kCells = 2048;  // of a histogram
/// Standard deviations from the mean: those are of the bank with all that is far away in it, so that what lies beyond
/// has a probability below 1 / 64^2.
constexpr double kHistogramReach = 64.0;
/// Slope of the tails, over that between them: few draws are there, and may lack one that is far out.
constexpr double kMostStretch = 8.0;

template <std::size_t kMost>
EndOfPack::Quantiles QuantilesOf(const NormalMixture<kMost>& mixture) noexcept ARMCMC_NONBLOCKING {
  EndOfPack::Quantiles q{};
  for (std::size_t k = 0; k < q.size(); ++k) q[k] = mixture.Quantile(EndOfPack::kLevels[k].p, EndOfPack::kLevels[k].z);
  return q;
}

}  // namespace

void Drift::StandStill() noexcept {
  lead_ = ParamMatrix::Zero(dim_, dim_);
  leads_ = false;
}

void Drift::ToEffective(const ModeData& data, const PosteriorMemory& last, LaplaceScratch* scratch) noexcept {
  StandStill();
  const Moments drift = MomentsOf(predicted_, Part::kDrift);
  const ParamMatrix precision = Inverse(drift.covariance);
  if (!(drift.weight > 0.0) || !precision.allFinite()) return;
  // About the mode of what drifts: errors that the parameters can explain would pass for a motion.
  Gaussian prior{last.mean, ParamMatrix::Zero(space_.dim, space_.dim)};
  prior.mean.head(dim_) = drift.mean;
  prior.precision.topLeftCorner(dim_, dim_) = precision;
  for (int d = dim_; d < space_.dim; ++d) prior.precision(d, d) = 1.0 / last.covariance(d, d);
  Gaussian fit;
  LaplaceFit(kernels_, model_, data, noise_, space_, prior, last.mean, kModeTolerance, scratch, &fit);
  const ParamVector mode = fit.mean.head(dim_);
  const LocalLikelihood local =
      ExpandLikelihood(kernels_, model_, data, noise_, space_, mode, last.log_noise_scale, scratch);
  ParamMatrix regular = precision;
  regular *= kLeastPrecision;
  regular.diagonal().array() += kLeastOfInitial;
  regular += local.information;
  const ParamMatrix lead = Product(Inverse(regular), local.lagged_information);
  leads_ = lead.allFinite() && MoveToEffective(local, mode, lead);
  if (leads_) lead_ = lead;
}

bool Drift::MoveToEffective(const LocalLikelihood& local, const ParamVector& mode, const ParamMatrix& lead) noexcept {
  const ParamMatrix pulled = Product(local.information, lead);
  const ParamMatrix lagged = Product(lead.transpose(), local.lagged_information);
  const VelocityLikelihood pack{
      .mode = mode,
      .lead = lead,
      .gradient = Multiply(lead.transpose(), local.gradient) - local.lagged_gradient,
      .mixed = pulled - local.lagged_information,
      .information = Product(lead.transpose(), pulled) - lagged - lagged.transpose() + local.twice_lagged_information};
  std::array<double, kFilters> log_evidence{};
  double top = 0.0;
  for (std::size_t i = 0; i < predicted_.size(); ++i) {
    if (IsOf(Part::kRest, i) || !(predicted_[i].weight > 0.0)) continue;
    work_[i] = predicted_[i];
    log_evidence[i] = work_[i].ToEffective(pack);
    if (!std::isfinite(log_evidence[i])) return false;
    top = std::fmax(top, log_evidence[i]);
  }
  for (std::size_t i = 0; i < predicted_.size(); ++i) {
    if (!(predicted_[i].weight > 0.0)) continue;
    if (IsOf(Part::kDrift, i)) predicted_[i] = work_[i];
    predicted_[i].weight *= std::exp(log_evidence[i] - top);
  }
  return true;
}

void Drift::FromEffective() noexcept {
  if (!leads_) return;
  for (std::size_t i = 0; i < bank_.size(); ++i)
    if (IsOf(Part::kDrift, i) && bank_[i].weight > 0.0) bank_[i].FromEffective(lead_);
}

void Drift::AddFilters(const Bank& bank, Part part, int d, Mixture* to) noexcept {
  for (std::size_t i = 0; i < bank.size(); ++i)
    if (IsOf(part, i)) to->Add(bank[i].weight, bank[i].u[d], bank[i].uu(d, d));
}

EndOfPack Drift::EndByDraws(const Draws& draws, int d, double mean, double variance, const EndOfPack::Quantiles& end,
                            double end_variance) const noexcept {
  const auto i = static_cast<std::size_t>(d);
  const double sd = std::sqrt(variance);
  if (!(sd > 0.0)) return {mean, std::nan(""), 1.0, space_.lower[i], space_.upper[i]};  // by rounding
  std::array<double, std::size_t{2} * kCells + 2> cells{};
  const double per_cell = kCells / (2.0 * kHistogramReach * sd);
  const double origin = mean - kHistogramReach * sd;
  kernels_.histogram(draws.u[i], draws.scratch, draws.count, per_cell, -origin * per_cell, kCells + 1, cells.data());
  // The first and the last cell have all that lies beyond, too, and are left out.
  std::size_t first = 1;
  std::size_t last = kCells - 1;  // past those that are not empty
  while (first + 1 < last && !(cells[2 * first] > 0.0)) ++first;
  while (last - 1 > first && !(cells[2 * (last - 1)] > 0.0)) --last;
  double total = 0.0;
  for (std::size_t c = first; c < last; ++c) total += cells[2 * c];
  EndOfPack::Quantiles effective{};
  double below = 0.0;
  std::size_t at = first;
  for (std::size_t k = 0; k < effective.size(); ++k) {
    const double target = EndOfPack::kLevels[k].p * total;
    while (at + 1 < last && below + cells[2 * at] < target) below += cells[2 * at++];
    const double part = cells[2 * at] > 0.0 ? std::fmin((target - below) / cells[2 * at], 1.0) : 0.0;
    effective[k] = origin + (static_cast<double>(at) + part) / per_cell;
  }
  // Beyond the outermost quantiles by the slope s that makes the variance that of the bank: with u = b(v) + s t(v),
  // t = 0 between them, it is Var[b] + 2 s Cov[b, t] + s^2 Var[t].
  const EndOfPack flat(effective, end, 0.0, 0.0, space_.lower[i], space_.upper[i]);
  double b_sum = 0.0, t_sum = 0.0, b_square = 0.0, t_square = 0.0, product = 0.0;
  const double per_total = 1.0 / total;
  for (std::size_t c = first; c < last; ++c) {
    if (!(cells[2 * c] > 0.0)) continue;
    const double w = cells[2 * c] * per_total;
    const double v = origin + (static_cast<double>(c) + cells[2 * c + 1] / cells[2 * c]) / per_cell;
    const double b = flat(v) - end[end.size() / 2];  // from the median: nothing cancels
    const double t = std::fmin(v - effective.front(), 0.0) + std::fmax(v - effective.back(), 0.0);
    b_sum += w * b;
    t_sum += w * t;
    b_square += w * b * b;
    t_square += w * t * t;
    product += w * b * t;
  }
  const double lacking = end_variance - (b_square - b_sum * b_sum);
  const double covariance = product - b_sum * t_sum;
  const double spread = t_square - t_sum * t_sum;
  const double root = std::fmax(covariance * covariance + lacking * spread, 0.0);
  const double most = kMostStretch * EndOfPack::AverageSlope(effective, end);
  const double slope = spread > 0.0 ? std::clamp((std::sqrt(root) - covariance) / spread, 0.0, most) : most;
  return {effective, end, 0.0, slope, space_.lower[i], space_.upper[i]};
}

bool Drift::FindEnd(const ModeData& data, const ParamVector& mean, double log_noise_scale, const Draws& draws,
                    double* p_drifted, LaplaceScratch* scratch, std::array<EndOfPack, kMaxParams>* end) noexcept {
  if (!started_ || share_ < kNegligible || !leads_) return false;
  Sampled sampled{.part = Part::kWhole,
                  .mean = mean,
                  .covariance = {},
                  .local = ExpandLikelihood(kernels_, model_, data, noise_, space_, mean, log_noise_scale, scratch)};
  work_ = bank_;
  const double as_sampled = *p_drifted;
  const bool updated = Update(sampled, Part::kWhole, 1.0);
  bool tilted = draws.share != nullptr && !space_.samples_noise_scale();
  if (tilted) {
    draws.WeighInBank();
    tilted = Tilt(sampled, draws, draws.count) > kLikenessInTails;
  }
  if (updated) {
    *p_drifted = p_drifted_ = CorrectedShare(draws, tilted, as_sampled);
    SetShare(p_drifted_);
  }
  std::array<EndOfPack::Quantiles, kMaxParams> effective{};
  ParamVector off = mean;  // of what was sampled from the expansion
  if (updated && !tilted) {
    std::array<Mixture, kMaxParams> drawn{};
    const auto add = [&](Part part, double share) noexcept ARMCMC_NONBLOCKING {
      sampled.part = part;
      const Moments m = ByExpansion(sampled);
      off -= share * m.mean;
      for (int d = 0; d < dim_; ++d) {
        Mixture* to = &drawn[static_cast<std::size_t>(d)];
        if (part == Part::kDrift && mixed_) {
          AddFilters(bank_, part, d, to);
        } else {
          to->Add(share, m.mean[d], m.covariance(d, d));
        }
      }
    };
    if (split_) {
      add(Part::kRest, 1.0 - as_sampled);
      add(Part::kDrift, as_sampled);
    } else {
      add(CarriedPart(), 1.0);
    }
    for (std::size_t d = 0; d < static_cast<std::size_t>(dim_); ++d) effective[d] = QuantilesOf(drawn[d]);
  }
  const Moments before = MomentsOf(bank_, Part::kWhole);
  FromEffective();
  const Moments after = MomentsOf(bank_, Part::kWhole);
  bool finite = updated;
  for (int d = 0; d < dim_ && finite; ++d) {
    const auto i = static_cast<std::size_t>(d);
    Mixture at_end;
    AddFilters(bank_, Part::kWhole, d, &at_end);
    const EndOfPack::Quantiles to = QuantilesOf(at_end);
    if (tilted) {
      (*end)[i] = EndByDraws(draws, d, before.mean[d], before.covariance(d, d), to, after.covariance(d, d));
    } else {
      (*end)[i] = EndOfPack(effective[i], to, off[d], EndOfPack::AverageSlope(effective[i], to), space_.lower[i],
                            space_.upper[i]);
    }
    finite = (*end)[i].IsFinite();
  }
  bank_ = work_;
  return finite;
}

bool Drift::FindEndOfChanged(const ParamVector& mean, const ParamMatrix& covariance,
                             std::array<EndOfPack, kMaxParams>* end) const noexcept {
  if (!started_ || !leads_ || !expects_drift_) return false;
  const ParamVector moved = Multiply(lead_, velocity_.mean);
  const ParamMatrix wider = Product(Product(lead_, velocity_.covariance), lead_.transpose());
  bool finite = true;
  for (int d = 0; d < dim_; ++d) {
    const auto i = static_cast<std::size_t>(d);
    (*end)[i] =
        EndOfPack(mean[d], moved[d], std::sqrt(1.0 + wider(d, d) / covariance(d, d)), space_.lower[i], space_.upper[i]);
    finite = finite && (*end)[i].IsFinite();
  }
  return finite;
}

}  // namespace armcmc
