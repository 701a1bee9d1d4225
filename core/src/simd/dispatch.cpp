#include "armcmc/estimator.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace simd {
namespace {

const Kernels& Choose() noexcept {
#if defined(ARMCMC_HAVE_AVX512)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) return kAvx512Kernels;
#endif
#if defined(ARMCMC_HAVE_AVX2)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return kAvx2Kernels;
#endif
  return kSse2Kernels;
}

}  // namespace

const Kernels& Best() noexcept {
  static const Kernels& kernels = Choose();
  return kernels;
}

}  // namespace simd

std::string_view InstructionSet() noexcept { return simd::Best().name; }

}  // namespace armcmc
