#pragma once

/// Marks a function that a real-time stage may call: it neither allocates, locks, throws nor blocks.
/// Checked at compile time by clang 20 and later (-Wfunction-effects) and at run time by RealtimeSanitizer;
/// expands to nothing for other compilers. Written after noexcept, on the first declaration; the definition has it too.
/// Source: clang's attribute `nonblocking`, https://clang.llvm.org/docs/FunctionEffectAnalysis.html.
///
/// ARMCMC_TRUST_NONBLOCKING_BEGIN .. END enclose the few functions whose body the compiler does not check, because
/// it cannot see that what they call does not block. Each such place says why. RealtimeSanitizer checks them as well.
///
/// Code that calls this library from a real-time thread of its own need not use either.
#if defined(__clang__) && __clang_major__ >= 20
#define ARMCMC_NONBLOCKING [[clang::nonblocking]]
#define ARMCMC_TRUST_NONBLOCKING_BEGIN \
  _Pragma("clang diagnostic push") _Pragma("clang diagnostic ignored \"-Wfunction-effects\"")
#define ARMCMC_TRUST_NONBLOCKING_END _Pragma("clang diagnostic pop")
#else
#define ARMCMC_NONBLOCKING
#define ARMCMC_TRUST_NONBLOCKING_BEGIN
#define ARMCMC_TRUST_NONBLOCKING_END
#endif
