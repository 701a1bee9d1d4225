#include "armcmc/plant_sim/noise.hpp"

#include <cmath>
#include <numbers>

namespace armcmc::plant_sim {

const char* NoiseKindName(NoiseKind kind) noexcept {
  switch (kind) {
    case NoiseKind::kNone: return "none";
    case NoiseKind::kGaussian: return "gaussian";
    case NoiseKind::kStudentT: return "student_t";
    case NoiseKind::kLaplace: return "laplace";
    case NoiseKind::kMixture: return "mixture";
    case NoiseKind::kRecorded: return "recorded";
  }
  return "";
}

double Draw(const NoiseLaw& law, Rng* rng) noexcept {
  switch (law.kind) {
    case NoiseKind::kNone:
    case NoiseKind::kRecorded: return 0.0;
    case NoiseKind::kGaussian: return law.std * rng->Normal();
    case NoiseKind::kStudentT: {
      const double radius = std::sqrt(law.dof * (std::pow(rng->Uniform(), -2.0 / law.dof) - 1.0));
      return law.std * radius * std::cos(2.0 * std::numbers::pi * rng->Uniform());
    }
    case NoiseKind::kLaplace: {
      const double u = rng->Uniform() - 0.5;
      return -law.std * std::copysign(std::log1p(-2.0 * std::abs(u)), u);
    }
    case NoiseKind::kMixture: {
      const bool outlier = rng->Uniform() < law.outlier_weight;
      return law.std * (outlier ? law.outlier_scale : 1.0) * rng->Normal();
    }
  }
  return 0.0;
}

double NoiseSd(const NoiseLaw& law) {
  switch (law.kind) {
    case NoiseKind::kNone: return 0.0;
    case NoiseKind::kRecorded:
    case NoiseKind::kGaussian: return law.std;
    case NoiseKind::kStudentT: return law.dof > 2.0 ? law.std * std::sqrt(law.dof / (law.dof - 2.0)) : law.std;
    case NoiseKind::kLaplace: return std::sqrt(2.0) * law.std;
    case NoiseKind::kMixture:
      return law.std * std::sqrt(1.0 + law.outlier_weight * (law.outlier_scale * law.outlier_scale - 1.0));
  }
  return 0.0;
}

}  // namespace armcmc::plant_sim
