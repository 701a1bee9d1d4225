#include "armcmc/baselines/rls.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/models/registry.hpp"
#include "armcmc/plant/program.hpp"
#include "armcmc/rng.hpp"
#include "simd/kernels.hpp"

namespace armcmc {

// A baseline for comparison, not part of the product: Eigen's products and factorisations are used as in text books.
// All types are bounded; the allocation tests and RealtimeSanitizer cover all of it.
ARMCMC_TRUST_NONBLOCKING_BEGIN

RlsFilter::RlsFilter(const FilterParts& parts)
    : parts_(parts), normal_table_(MarginalTable::Normal()), dim_(parts.space.num_parameters) {
  prior_mean_ = ParamVector::Zero(dim_);
  prior_ = ParamMatrix::Identity(dim_, dim_);
  if (const PlantProgram* plant = parts.settings.plant.get(); plant != nullptr) {
    several_modes_ = plant->info().num_modes > 1;
    prediction_ = std::make_unique<PredictionTile>();
  } else {
    const ModelInfo& info = *CompiledModels()[static_cast<std::size_t>(parts.model)];
    several_modes_ = info.num_modes > 1;
    form_ = info.compiled->regression;
  }
  if (form_ != nullptr) form_->start(parts_.space, &prior_mean_, &prior_);
  Reset();
}

void RlsFilter::Reset() noexcept {
  z_ = prior_mean_;
  p_ = prior_;
  known_ = false;
}

void RlsFilter::Resume() noexcept {
  if (several_modes_ && !parts_.settings.baseline.recall) {
    Reset();
  } else if (!several_modes_ && parts_.settings.baseline.rls_reset) {
    p_ = prior_;
  }
}

void RlsFilter::Update(const ParamVector& phi, double y, double r) noexcept {
  p_ /= parts_.settings.baseline.rls_forgetting;
  for (int d = 0; d < dim_; ++d) {
    // Without excitation the covariance would grow without bound.
    const double excess = std::sqrt(prior_(d, d) / p_(d, d));
    if (excess >= 1.0) continue;
    p_.row(d) *= excess;
    p_.col(d) *= excess;
  }
  const ParamVector pp = p_ * phi;
  const double s = r + phi.dot(pp);
  z_ += pp * ((y - phi.dot(z_)) / s);
  p_ -= pp * pp.transpose() / s;
  p_ = (0.5 * (p_ + p_.transpose())).eval();
  for (int d = 0; d < dim_; ++d) p_(d, d) = std::fmax(p_(d, d), 1e-24 * prior_(d, d));
}

double RlsFilter::SquareGain(const ModeData& data, std::size_t sample, const ParamVector& z,
                             const ParamMatrix& p) const noexcept {
  const double rate = data.feature[0][sample];
  if (rate == 0.0) return 1.0;  // the sample carries no information
  ParamVector phi(dim_);
  double gain = 0.0;
  for (int d = 0; d < dim_; ++d) {
    const auto i = static_cast<std::size_t>(d);
    phi[d] = parts_.space.scale[i] * data.feature[i][sample] / rate;
    gain += parts_.space.offset[i] * data.feature[i][sample] / rate;
  }
  gain += phi.dot(z);
  return gain * gain + phi.dot(p * phi);
}

void RlsFilter::Saturate() noexcept {
  const ParameterSpace& s = parts_.space;
  if (form_ != nullptr) {
    form_->saturate(s, &z_);
    return;
  }
  for (int d = 0; d < dim_; ++d)
    z_[d] = std::clamp(z_[d], s.lower[static_cast<std::size_t>(d)], s.upper[static_cast<std::size_t>(d)]);
}

void RlsFilter::ToDraw(const ParamVector& z, double* u) const noexcept {
  const ParameterSpace& s = parts_.space;
  std::array<double, kMaxParams> theta{};
  if (form_ != nullptr) form_->to_theta(z, theta.data());
  for (int d = 0; d < dim_; ++d) {
    const auto i = static_cast<std::size_t>(d);
    const double value = form_ != nullptr ? (theta[i] - s.offset[i]) / s.scale[i] : z[d];
    u[d] = std::clamp(value, s.lower[i], s.upper[i]);
  }
  for (int d = dim_; d < s.dim; ++d) u[d] = 0.0;  // the noise scale at its prior mean
}

void RlsFilter::UpdateByAll(const ModeData& data, const ParamVector& gain_z, const ParamMatrix& gain_p) noexcept {
  const ParameterSpace& s = parts_.space;
  const double noise = std::exp(s.log_noise_scale), mean = parts_.noise.settings().mean;
  const bool of_rate = parts_.settings.regress_rate;
  ParamVector phi(dim_);
  for (int n = 0; n < data.num_samples; ++n) {
    const auto i = static_cast<std::size_t>(n);
    double y = data.target[i] - (of_rate ? 0.0 : mean);
    double r = noise * noise;
    if (form_ != nullptr) {
      if (!form_->row(data, i, noise, &phi, &y, &r)) continue;
    } else {
      // The noise of a rate, its mean included, is in what is measured of it and not in the target.
      const double share = of_rate && data.feature[0][i] != 0.0 ? 1.0 - mean / data.feature[0][i] : 1.0;
      for (int d = 0; d < dim_; ++d) {
        const auto id = static_cast<std::size_t>(d);
        const double feature = share * data.feature[id][i];
        phi[d] = s.scale[id] * feature;
        y -= s.offset[id] * feature;
      }
      if (of_rate) r *= SquareGain(data, i, gain_z, gain_p);
    }
    Update(phi, y, r);
    Saturate();
  }
}

ParamVector RlsFilter::Linearise(const ModeData& data, const ParamVector& z, const ParamMatrix& p) noexcept {
  constexpr double kSmallest = 1e-5;  // in prior standard deviations: the rounding error of a difference
  const ParameterSpace& s = parts_.space;
  ParamVector apart(dim_);
  for (int d = 0; d < dim_; ++d) {
    const auto i = static_cast<std::size_t>(d);
    const double sd = std::fmax(std::sqrt(p(d, d)), kSmallest);
    const double high = std::fmin(z[d] + sd, s.upper[i]), low = std::fmax(z[d] - sd, s.lower[i]);
    apart[d] = high - low;
    theta_.value[i].fill(s.Theta(d, z[d]));
    theta_.value[i][1 + 2 * i] = s.Theta(d, high);
    theta_.value[i][2 + 2 * i] = s.Theta(d, low);
  }
  parts_.kernels.predict(parts_.model, data, theta_, prediction_.get());
  return apart;
}

void RlsFilter::UpdateByAllLinearised(const ModeData& data, const ParamVector& z, const ParamMatrix& p) noexcept {
  static_assert(1 + 2 * kMaxParams <= kTileLanes);
  const ParamVector apart = Linearise(data, z, p);
  const double variance = std::exp(2.0 * parts_.space.log_noise_scale);
  ParamVector phi(dim_);
  for (std::size_t n = 0; n < static_cast<std::size_t>(data.num_samples); ++n) {
    const auto& law = prediction_->value[n];
    double y = data.target[n] - parts_.noise.settings().mean - law[0];
    for (int d = 0; d < dim_; ++d) {
      const auto high = 1 + 2 * static_cast<std::size_t>(d);
      phi[d] = apart[d] > 0.0 ? (law[high] - law[high + 1]) / apart[d] : 0.0;
      y += phi[d] * z[d];
    }
    if (!phi.allFinite() || !std::isfinite(y)) continue;  // the law has no value there
    Update(phi, y, variance);
    Saturate();
  }
}

void RlsFilter::Again(const ModeData& data, const ParamVector& before_z, const ParamMatrix& before_p) noexcept {
  const ParamVector z = z_;
  const ParamMatrix p = p_;
  z_ = before_z;
  p_ = before_p;
  prediction_ != nullptr ? UpdateByAllLinearised(data, z, p) : UpdateByAll(data, z, p);
}

Status RlsFilter::Run(const ModeData& data, std::uint64_t pack, std::uint64_t mode, Nanos, ClockRef, int,
                      ModeDraws* out) noexcept {
  constexpr int kLinearisations = 3;
  const ParameterSpace& s = parts_.space;
  const ParamVector old_z = z_;
  const ParamMatrix old_p = p_;
  // For a rate, repeated with the weights from the gains of this pack: before the first pack the gains
  // are unknown.
  const int passes = prediction_ != nullptr ? kLinearisations : parts_.settings.regress_rate ? 2 : 1;
  for (int pass = 0; pass < passes && z_.allFinite() && p_.allFinite(); ++pass) Again(data, old_z, old_p);
  if (!z_.allFinite() || !p_.allFinite()) {
    z_ = old_z;
    p_ = old_p;
    return Status::kNonFinite;
  }
  FillStep(data, kDraws, 0, out);
  out->point_is_mode = true;
  ToDraw(z_, out->mode_u.data());
  ParamMatrix root;
  (void)CholeskyFactor(p_, &root);
  RandomStream stream(parts_.settings.sampler.seed, pack, mode);
  std::array<double, kMaxParams> u{};
  ParamVector draw(dim_);
  for (int k = 0; k < kDraws; ++k) {
    for (int d = 0; d < dim_; ++d) draw[d] = normal_table_.Draw(stream.Uniform());
    const ParamVector at = z_ + Multiply(root, draw);
    ToDraw(at.allFinite() ? at : z_, u.data());
    for (int d = 0; d < s.dim; ++d) out->u[static_cast<std::size_t>(d)][k] = u[static_cast<std::size_t>(d)];
    out->weight[k] = 1.0 / kDraws;
    out->visits[k] = 1;
    out->chain[k] = k;
  }
  known_ = known_ || IsInformed(s, *out);
  out->known = known_;
  return Status::kOk;
}

ARMCMC_TRUST_NONBLOCKING_END

}  // namespace armcmc
