#include <array>
#include <cstddef>
#include <string_view>

#include "armcmc/estimator.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace simd {
namespace {

#if defined(ARMCMC_HAVE_AVX512)
bool RunsAvx512() noexcept { return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"); }
#endif
#if defined(ARMCMC_HAVE_AVX2)
bool RunsAvx2() noexcept { return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); }
#endif

/// Sets that this build has and this CPU runs, widest first.
struct Runnable {
  std::array<const Kernels*, 3> sets{};
  int size = 0;
};

Runnable AllRunnable() noexcept {
  Runnable all;
  const auto add = [&](const Kernels& kernels) noexcept { all.sets[static_cast<std::size_t>(all.size++)] = &kernels; };
#if defined(ARMCMC_HAVE_AVX512)
  if (RunsAvx512()) add(kAvx512Kernels);
#endif
#if defined(ARMCMC_HAVE_AVX2)
  if (RunsAvx2()) add(kAvx2Kernels);
#endif
#if defined(ARMCMC_HAVE_NEON)
  add(kNeonKernels);  // every AArch64 CPU has it
#endif
  add(kPortableKernels);
  return all;
}

const Kernels*& Chosen() noexcept {
  static const Kernels* kernels = AllRunnable().sets[0];
  return kernels;
}

}  // namespace

const Kernels& Best() noexcept { return *Chosen(); }

bool Use(std::string_view name) noexcept {
  const Runnable all = AllRunnable();
  for (int i = 0; i < all.size; ++i) {
    const Kernels* kernels = all.sets[static_cast<std::size_t>(i)];
    if (kernels->name != name) continue;
    Chosen() = kernels;
    return true;
  }
  return false;
}

}  // namespace simd

std::string_view InstructionSet() noexcept { return simd::Best().name; }

bool UseInstructionSet(std::string_view name) noexcept { return simd::Use(name); }

}  // namespace armcmc
