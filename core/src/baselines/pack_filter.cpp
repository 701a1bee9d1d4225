#include "armcmc/baselines/pack_filter.hpp"

#include <cmath>

#include "armcmc/baselines/metropolis.hpp"
#include "armcmc/baselines/particle_filter.hpp"
#include "armcmc/baselines/rls.hpp"

namespace armcmc {

std::unique_ptr<PackFilter> MakeFilter(const FilterParts& parts) {
  switch (parts.settings.method) {
    case Method::kRls: return std::make_unique<RlsFilter>(parts);
    case Method::kParticleFilter: return std::make_unique<ParticleFilter>(parts);
    case Method::kMetropolis:
    case Method::kArmcmc: break;
  }
  return std::make_unique<MetropolisFilter>(parts);
}

void FillStep(const ModeData& data, int draws, int burn_in, ModeDraws* out) noexcept {
  out->updated = true;
  out->decision = Decision::kReinforcement;
  out->num_samples = data.num_samples;
  out->zeta = out->zeta_threshold = 0.0;
  out->lambda = 1.0;
  out->k_min = 0;
  out->draws = draws;
  out->burn_in = burn_in;
  out->truncated = false;
  out->point_is_mode = false;
  out->acceptance = 1.0;
  out->log_evidence = 0.0;
  out->p_changed = 0.0;
  out->kish_ess = draws;
  out->mode_index = 0;
}

bool IsInformed(const ParameterSpace& space, const ModeDraws& draws) noexcept {
  constexpr double kInformedSd = 0.9;  // as in the ARMCMC estimator
  for (int d = 0; d < space.num_parameters; ++d) {
    const double* u = draws.u[static_cast<std::size_t>(d)];
    double mean = 0.0;
    double square = 0.0;
    for (int k = 0; k < draws.draws; ++k) {
      mean += draws.weight[k] * u[k];
      square += draws.weight[k] * u[k] * u[k];
    }
    if (square - mean * mean < std::pow(kInformedSd * space.prior_sd[static_cast<std::size_t>(d)], 2)) return true;
  }
  return false;
}

}  // namespace armcmc
