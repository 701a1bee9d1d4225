#pragma once

// One more version of a function for processors with wider vectors, bit-identical: no operation is fused. Not
// under sanitizers, which have to start before such a choice is made.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define ARMCMC_FOR_WIDER_LANES __attribute__((target_clones("default", "avx2", "arch=x86-64-v4")))
#else
#define ARMCMC_FOR_WIDER_LANES
#endif
/// Inside of such a function, so that it takes part.
#define ARMCMC_INSIDE __attribute__((always_inline)) inline

/// Before a loop over lanes that may write where it reads: vectors all the same, and not unrolled before they are made.
#if defined(__GNUC__) && !defined(__clang__)
#define ARMCMC_OVER_LANES _Pragma("GCC ivdep") _Pragma("GCC unroll 1")
#else
#define ARMCMC_OVER_LANES
#endif
