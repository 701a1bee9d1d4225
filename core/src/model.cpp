#include "armcmc/model.hpp"

#include "armcmc/plant/program.hpp"

namespace armcmc {

void ModelInfo::Report(const double* theta, const PlantConstants& constants, double* values) const noexcept {
  if (described != nullptr) {
    for (int r = 0; r < num_reported; ++r) values[r] = described->Report(r, theta);
    return;
  }
  int own = num_parameters - num_added;
  if (report == nullptr) {
    for (int d = 0; d < own; ++d) values[d] = theta[d];
  } else {
    report(theta, constants, values);
  }
  for (int r = num_reported - num_added; r < num_reported; ++r) values[r] = theta[own++];
}

bool ModelInfo::IsReportedAsSampled(int r) const noexcept {
  return described != nullptr ? described->IsReportedAsSampled(r) : report == nullptr;
}

double ModelInfo::Sampled(int d, double reported_value) const noexcept {
  return described != nullptr ? described->Sampled(d, reported_value) : reported_value;
}

}  // namespace armcmc
