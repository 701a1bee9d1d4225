#include "armcmc/noise_model.hpp"

#include <cmath>
#include <numbers>

namespace armcmc {
namespace {

const double kHalfLog2Pi = 0.5 * std::log(2.0 * std::numbers::pi);

/// d log p(e) / d e for scale 1, by central difference: only used at set-up.
double Slope(const NoiseModel& model, double e) {
  constexpr double kStep = 1e-5;
  return (model.LogDensity(e + kStep, 1.0) - model.LogDensity(e - kStep, 1.0)) / (2.0 * kStep);
}

}  // namespace

NoiseModel::NoiseModel(const NoiseSettings& settings) : settings_(settings) {
  const double nu = settings_.dof;
  switch (settings_.kind) {
    case NoiseKind::kGaussian:
    case NoiseKind::kMixture: log_constant_ = -kHalfLog2Pi; break;
    case NoiseKind::kStudentT:
      log_constant_ = std::lgamma(0.5 * (nu + 1.0)) - std::lgamma(0.5 * nu) - 0.5 * std::log(nu * std::numbers::pi);
      break;
    case NoiseKind::kLaplace: log_constant_ = -std::numbers::ln2; break;
  }
  // Moments under the law by the midpoint rule in s, e = sinh(s): reaches |e| = 1e6 with fine steps near zero.
  constexpr int kNodes = 40'000;
  const double reach = std::asinh(1e6);
  double mass = 0, d1 = 0, d2 = 0, l1 = 0, l2 = 0, info = 0, scale_info = 0;
  for (int i = 0; i < kNodes; ++i) {
    const double s = reach * (2.0 * (i + 0.5) / kNodes - 1.0);
    const double e = std::sinh(s);
    const double log_p = LogDensity(e, 1.0);
    const double w = std::exp(log_p) * std::cosh(s) * 2.0 * reach / kNodes;
    const double d = Deviance(e, 1.0);
    const double slope = Slope(*this, e);
    const double scale_slope = -1.0 - e * slope;
    mass += w;
    d1 += w * d;
    d2 += w * d * d;
    l1 += w * log_p;
    l2 += w * log_p * log_p;
    info += w * slope * slope;
    scale_info += w * scale_slope * scale_slope;
  }
  deviance_mean_ = d1 / mass;
  deviance_sd_ = std::sqrt(std::fmax(d2 / mass - deviance_mean_ * deviance_mean_, 1e-12));
  log_density_mean_ = l1 / mass;
  log_density_sd_ = std::sqrt(std::fmax(l2 / mass - log_density_mean_ * log_density_mean_, 1e-12));
  information_ = info / mass;
  scale_information_ = scale_info / mass;
}

double NoiseModel::LogDensity(double e, double scale) const noexcept {
  const double z = e / scale;
  const double log_scale = std::log(scale);
  switch (settings_.kind) {
    case NoiseKind::kGaussian: return log_constant_ - 0.5 * z * z - log_scale;
    case NoiseKind::kStudentT:
      return log_constant_ - 0.5 * (settings_.dof + 1.0) * std::log1p(z * z / settings_.dof) - log_scale;
    case NoiseKind::kLaplace: return log_constant_ - std::fabs(z) - log_scale;
    case NoiseKind::kMixture: {
      const double w = settings_.outlier_weight;
      const double c = settings_.outlier_scale;
      const double inlier = -0.5 * z * z;
      const double outlier = -0.5 * z * z / (c * c);
      // Both terms relative to the larger exponent, the outlier's, so that nothing underflows.
      return log_constant_ - log_scale + outlier + std::log((1.0 - w) * std::exp(inlier - outlier) + w / c);
    }
  }
  return 0.0;
}

double NoiseModel::SquareWeight(double e, double scale) const noexcept {
  const double z = e / scale;
  const double base = 1.0 / (scale * scale);
  switch (settings_.kind) {
    case NoiseKind::kGaussian: return base;
    case NoiseKind::kStudentT: return base * (settings_.dof + 1.0) / (settings_.dof + z * z);
    case NoiseKind::kLaplace: return base / std::fmax(std::fabs(z), 0.5);
    case NoiseKind::kMixture: {
      const double w = settings_.outlier_weight;
      const double c = settings_.outlier_scale;
      const double gap = std::exp(-0.5 * z * z * (1.0 - 1.0 / (c * c)));
      const double inlier = (1.0 - w) * gap;
      const double outlier = w / c;
      return base * (inlier + outlier / (c * c)) / (inlier + outlier);
    }
  }
  return base;
}

double NoiseModel::Deviance(double e, double scale) const noexcept {
  return 2.0 * (LogDensity(0.0, scale) - LogDensity(e, scale));
}

}  // namespace armcmc
