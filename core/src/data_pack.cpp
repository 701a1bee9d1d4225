#include "armcmc/data_pack.hpp"

#include <cmath>

namespace armcmc {

Status DataPack::Validate() const noexcept ARMCMC_NONBLOCKING {
  if (seq < 1) return Status::kBadPack;
  if (num_samples < 1 || num_samples > kMaxPackSamples) return Status::kBadPack;
  if (num_inputs < 1 || num_inputs > kMaxPackInputs) return Status::kBadPack;
  if (!(dt > 0.0) || !std::isfinite(dt) || !std::isfinite(t_last_s)) return Status::kBadPack;
  bool finite = true;
  for (int n = 0; n < num_samples; ++n) {
    const auto i = static_cast<std::size_t>(n);
    finite = finite && std::isfinite(y[i]);
    for (int k = 0; k < num_inputs; ++k) finite = finite && std::isfinite(u[i][static_cast<std::size_t>(k)]);
  }
  return finite ? Status::kOk : Status::kBadPack;
}

}  // namespace armcmc
