// Parameters that move within a pack, for a sampler that takes the parameters of a pack for constant.
#include <array>
#include <cmath>

#include "armcmc/drift.hpp"
#include "armcmc/linear_algebra.hpp"

namespace armcmc {
namespace {

/// Of the prior's precision in the inverse of H: H alone may have directions that the pack does not determine.
constexpr double kLeastPrecision = 1e-4;
/// Share of the effective draws that an expansion that is of use leaves, for quantiles in the tails.
constexpr double kLikenessInTails = 0.5;

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
  regular += local.information;
  const ParamMatrix lead = Product(Inverse(regular), local.lagged_information);
  leads_ = lead.allFinite() && MoveToEffective(local, mode, lead);
  if (leads_) lead_ = lead;
}

bool Drift::MoveToEffective(const LocalLikelihood& local, const ParamVector& mode, const ParamMatrix& lead) noexcept {
  const Eigen::Index n = dim_;
  const ParamMatrix pulled = Product(local.information, lead);
  const ParamMatrix lagged = Product(lead.transpose(), local.lagged_information);
  JointVector gradient(2 * n);
  gradient.head(n).setZero();
  gradient.tail(n) = Multiply(lead.transpose(), local.gradient) - local.lagged_gradient;
  JointMatrix information(2 * n, 2 * n);
  information.topLeftCorner(n, n).setZero();
  information.topRightCorner(n, n) = pulled - local.lagged_information;
  information.bottomLeftCorner(n, n) = information.topRightCorner(n, n).transpose();
  information.bottomRightCorner(n, n) =
      Product(lead.transpose(), pulled) - lagged - lagged.transpose() + local.twice_lagged_information;
  std::array<double, kFilters> log_evidence{};
  double top = 0.0;
  for (std::size_t i = 0; i < predicted_.size(); ++i) {
    const Filter& f = predicted_[i];
    if (IsOf(Part::kRest, i) || !(f.weight > 0.0)) continue;
    const ParamMatrix moved = Product(lead, f.ww);
    const ParamMatrix with_u = Product(lead, f.uw.transpose());
    JointVector state(2 * n);
    state.head(n) = f.u - mode - Multiply(lead, f.w);
    state.tail(n) = f.w;
    JointMatrix spread(2 * n, 2 * n);
    spread.topLeftCorner(n, n) = f.uu - with_u - with_u.transpose() + Product(moved, lead.transpose());
    spread.topRightCorner(n, n) = f.uw - moved;
    spread.bottomLeftCorner(n, n) = spread.topRightCorner(n, n).transpose();
    spread.bottomRightCorner(n, n) = f.ww;
    log_evidence[i] = MultiplyByQuadratic(gradient, information, &state, &spread);
    work_[i] = {.weight = f.weight,
                .u = mode + state.head(n),
                .w = state.tail(n),
                .uu = spread.topLeftCorner(n, n),
                .uw = spread.topRightCorner(n, n),
                .ww = spread.bottomRightCorner(n, n)};
    if (!std::isfinite(log_evidence[i]) || !state.allFinite() || !IsPositiveDefinite(work_[i].uu)) return false;
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
  for (std::size_t i = 0; i < bank_.size(); ++i) {
    Filter& f = bank_[i];
    if (IsOf(Part::kRest, i) || !(f.weight > 0.0)) continue;
    const ParamMatrix moved = Product(lead_, f.ww);
    const ParamMatrix with_u = Product(lead_, f.uw.transpose());
    f.u += Multiply(lead_, f.w);
    f.uu += with_u + with_u.transpose() + Product(moved, lead_.transpose());
    f.uw += moved;
  }
}

void Drift::AddFilters(const Bank& bank, Part part, int d, Mixture* to) noexcept {
  for (std::size_t i = 0; i < bank.size(); ++i)
    if (IsOf(part, i)) to->Add(bank[i].weight, bank[i].u[d], bank[i].uu(d, d));
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
    for (int k = 0; k < draws.count; ++k)
      draws.scratch[k] = draws.of_part ? draws.weight[k] : draws.weight[k] * (1.0 - draws.share[k]);
    tilted = Tilt(sampled, draws, draws.count) > kLikenessInTails;
  }
  if (updated) {
    *p_drifted = p_drifted_ = CorrectedShare(draws, tilted, as_sampled);
    SetShare(p_drifted_);
  }
  std::array<EndOfPack::Quantiles, kMaxParams> effective{};
  ParamVector off = mean;  // of what was sampled from the expansion
  if (updated && tilted) {
    const Moments whole = MomentsOf(bank_, Part::kWhole);
    off.setZero();
    for (int d = 0; d < dim_; ++d)
      effective[static_cast<std::size_t>(d)] =
          QuantilesByDraws(draws, d, whole.mean[d], std::sqrt(whole.covariance(d, d)));
  } else if (updated) {
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
  FromEffective();
  bool finite = updated;
  for (int d = 0; d < dim_ && finite; ++d) {
    const auto i = static_cast<std::size_t>(d);
    Mixture at_end;
    AddFilters(bank_, Part::kWhole, d, &at_end);
    (*end)[i] = EndOfPack(effective[i], QuantilesOf(at_end), off[d], space_.lower[i], space_.upper[i]);
    finite = (*end)[i].IsFinite();
  }
  bank_ = work_;
  return finite;
}

bool Drift::FindEndAfterChange(const ParamVector& mean, const ParamMatrix& covariance,
                               std::array<EndOfPack, kMaxParams>* end) noexcept {
  if (!started_ || !leads_) return false;
  Predict(elapsed_s_, gap_s_);
  ExpectDrift();
  if (share_ < kNegligible) return false;
  work_ = predicted_;
  for (Filter& f : work_) {
    if (!(f.weight > 0.0)) continue;
    f.u = Multiply(lead_, f.w);
    f.uu = Product(Product(lead_, f.ww), lead_.transpose());
  }
  const Moments moved = MomentsOf(work_, Part::kWhole);
  bool finite = true;
  for (int d = 0; d < dim_; ++d) {
    const auto i = static_cast<std::size_t>(d);
    (*end)[i] = EndOfPack(mean[d], moved.mean[d], std::sqrt(1.0 + moved.covariance(d, d) / covariance(d, d)),
                          space_.lower[i], space_.upper[i]);
    finite = finite && (*end)[i].IsFinite();
  }
  return finite;
}

}  // namespace armcmc
