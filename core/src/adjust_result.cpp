#include "armcmc/adjust_result.hpp"

#include "armcmc/mode_data.hpp"

namespace armcmc {

AdjustResult::AdjustResult(int num_modes_in, int dim, int capacity) : num_modes(num_modes_in) {
  // Whole tiles, and one more: kernels write whole tiles.
  const auto cap = static_cast<std::size_t>(RoundUpToTile(capacity) + kTileLanes);
  const auto modes_count = static_cast<std::size_t>(num_modes);
  doubles_.resize(modes_count * cap * static_cast<std::size_t>(dim + 2));
  integers_.resize(modes_count * cap * 2);
  double* d = doubles_.data();
  std::int32_t* i = integers_.data();
  for (std::size_t m = 0; m < modes_count; ++m) {
    ModeDraws& draws = modes[m];
    draws.dim = dim;
    for (int k = 0; k < dim; ++k, d += cap) draws.u[static_cast<std::size_t>(k)] = d;
    draws.weight = d;
    d += cap;
    draws.changed = d;
    d += cap;
    draws.visits = i;
    i += cap;
    draws.chain = i;
    i += cap;
  }
}

}  // namespace armcmc
