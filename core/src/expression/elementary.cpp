#include "armcmc/expression/elementary.hpp"

#include "simd/kernels.hpp"

namespace armcmc::expression {

bool Elementary(Op op, std::size_t count, const double* a, const double* b, double* out) noexcept {
  return simd::Best().elementary(op, count, a, b, out);
}

}  // namespace armcmc::expression
