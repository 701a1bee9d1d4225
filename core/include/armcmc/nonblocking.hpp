#pragma once

/// Marks a function that a real-time stage may call: it neither allocates, locks, throws nor blocks.
/// Checked at compile time by clang 20 and later (-Wfunction-effects) and at run time by RealtimeSanitizer;
/// expands to nothing for other compilers. Written after noexcept.
#if defined(__clang__) && __clang_major__ >= 20
#define ARMCMC_NONBLOCKING [[clang::nonblocking]]
#else
#define ARMCMC_NONBLOCKING
#endif
