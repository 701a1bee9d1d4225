#include "armcmc/density_block.hpp"

namespace armcmc {

void DensityBlock::Straighten(const double* u, double* e) const noexcept {
  for (int i = 0; i < dim; ++i) {
    const auto& row = whiten[static_cast<std::size_t>(i)];
    double sum = 0.0;
    for (int j = 0; j < dim; ++j) sum += row[static_cast<std::size_t>(j)] * (u[j] - mean[static_cast<std::size_t>(j)]);
    e[i] = sum;
  }
  if (!bent) return;
  const double c = Clamped(e[0]);
  for (int i = 1; i < dim; ++i) e[i] -= BendAt(i, c, e);
}

double DensityBlock::Density(const double* u) const noexcept {
  Row e{};
  Straighten(u, e.data());
  const double c = Clamped(e[0]);
  double p = norm;
  for (int i = 0; i < dim; ++i) {
    const auto ii = static_cast<std::size_t>(i);
    const double shrink = tapered ? std::exp(-LogThickness(i, c)) : 1.0;
    p *= shrink * marginal[ii]->Density((e[ii] * shrink - center[ii]) / scale[ii]);
  }
  return p;
}

}  // namespace armcmc
