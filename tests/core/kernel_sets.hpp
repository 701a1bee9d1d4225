#pragma once

#include <vector>

#include "simd/kernels.hpp"

namespace armcmc::test {

/// Extended precision for references.
constexpr long double Wide(double x) { return static_cast<long double>(x); }

/// A control of two coordinates in which every term counts.
inline constexpr simd::QuadraticControl kControl{.dim = 2,
                                                 .most = 0.5,
                                                 .constant = 0.3,
                                                 .centre = {0.1, -0.4},
                                                 .slope = {-0.7, 0.2},
                                                 .curvature = {{0.15}, {-0.3, 0.05}}};

/// Kernels of every instruction set that was built and that this CPU runs.
inline std::vector<const simd::Kernels*> RunnableKernels() {
  std::vector<const simd::Kernels*> sets{&simd::kPortableKernels};
#if defined(ARMCMC_HAVE_AVX2)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) sets.push_back(&simd::kAvx2Kernels);
#endif
#if defined(ARMCMC_HAVE_AVX512)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) sets.push_back(&simd::kAvx512Kernels);
#endif
#if defined(ARMCMC_HAVE_NEON)
  sets.push_back(&simd::kNeonKernels);
#endif
  return sets;
}

/// Those among them that fuse multiply and add, and so give the same bits.
inline std::vector<const simd::Kernels*> FusedKernels() {
  std::vector<const simd::Kernels*> sets = RunnableKernels();
  sets.erase(sets.begin());
  return sets;
}

}  // namespace armcmc::test
