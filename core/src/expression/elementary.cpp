#include "armcmc/expression/elementary.hpp"

#include "simd/kernels.hpp"

namespace armcmc::expression {

bool Elementary(Op op, std::size_t count, const double* a, double* out) noexcept ARMCMC_NONBLOCKING {
  return simd::Best().elementary(op, count, a, out);
}

}  // namespace armcmc::expression
