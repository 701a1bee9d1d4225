// No include guard on purpose: compiled once per instruction set, with ARMCMC_SIMD_NAMESPACE and
// ARMCMC_SIMD_LANES set by the including file, and ARMCMC_SIMD_NEON where it is the vectors of AArch64. Only this file
// knows the instruction set.

#include <cstdint>
#include <cstring>

#if defined(__FMA__)
#include <immintrin.h>
#elif defined(ARMCMC_SIMD_NEON)
#include <arm_neon.h>
#endif

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {

/// Vector arithmetic in the compiler's own vector type: operators + - * / come with it.
struct Simd {
  static constexpr int kLanes = ARMCMC_SIMD_LANES;
#if defined(__FMA__) || defined(ARMCMC_SIMD_NEON)
  static constexpr bool kFused = true;  ///< Fma() rounds once.
#else
  static constexpr bool kFused = false;
#endif
  typedef double V __attribute__((vector_size(8 * ARMCMC_SIMD_LANES)));
  typedef std::int64_t I __attribute__((vector_size(8 * ARMCMC_SIMD_LANES)));

  static V Set(double a) noexcept {
#if defined(__AVX512F__) && ARMCMC_SIMD_LANES == 8
    return _mm512_set1_pd(a);
#elif defined(__AVX2__) && ARMCMC_SIMD_LANES == 4
    return _mm256_set1_pd(a);
#else
    V v;
    for (int i = 0; i < kLanes; ++i) v[i] = a;
    return v;
#endif
  }
  static V Load(const double* p) noexcept {
    V v;
    std::memcpy(&v, p, sizeof v);
    return v;
  }
  static void Store(double* p, V v) noexcept { std::memcpy(p, &v, sizeof v); }

  /// True when any lane of a comparison is set.
  static bool Any(I mask) noexcept {
#if defined(__AVX512F__) && ARMCMC_SIMD_LANES == 8
    return _mm512_test_epi64_mask(reinterpret_cast<__m512i>(mask), reinterpret_cast<__m512i>(mask)) != 0;
#elif defined(__AVX2__) && ARMCMC_SIMD_LANES == 4
    return _mm256_movemask_pd(FromBits(mask)) != 0;
#elif defined(ARMCMC_SIMD_NEON)
    return vmaxvq_u32(reinterpret_cast<uint32x4_t>(mask)) != 0;
#else
    std::int64_t all = 0;
    for (int i = 0; i < kLanes; ++i) all |= mask[i];
    return all != 0;
#endif
  }

  static V Sqrt(V a) noexcept {
#if defined(__AVX512F__) && ARMCMC_SIMD_LANES == 8
    return _mm512_maskz_sqrt_pd(0xff, a);
#elif defined(__AVX2__) && ARMCMC_SIMD_LANES == 4
    return _mm256_sqrt_pd(a);
#elif defined(ARMCMC_SIMD_NEON)
    return vsqrtq_f64(a);
#else
    for (int i = 0; i < kLanes; ++i) a[i] = __builtin_sqrt(a[i]);
    return a;
#endif
  }

  /// table[index[lane]].
  static V Gather(const double* table, I index) noexcept {
#if defined(__AVX512F__) && ARMCMC_SIMD_LANES == 8
    return _mm512_mask_i64gather_pd(V{}, 0xff, reinterpret_cast<__m512i>(index), table, 8);
#elif defined(__AVX2__) && ARMCMC_SIMD_LANES == 4
    return _mm256_i64gather_pd(table, reinterpret_cast<__m256i>(index), 8);
#else
    V v{};
    for (int i = 0; i < kLanes; ++i) v[i] = table[index[i]];
    return v;
#endif
  }

  /// low = table[index[lane]], high = table[index[lane] + 1]: neighbours are loaded together, which takes less than
  /// half of the time of two gathers.
  static void GatherPairs(const double* table, I index, V* low, V* high) noexcept {
#if (defined(__AVX512F__) && ARMCMC_SIMD_LANES == 8) || (defined(__AVX2__) && ARMCMC_SIMD_LANES == 4)
    alignas(64) std::int64_t at[kLanes];
    std::memcpy(at, &index, sizeof at);
    const auto pair = [table, &at](int lane) noexcept { return _mm_loadu_pd(table + at[lane]); };
    const auto four = [pair](int lane) noexcept {  // lane, lane + 2
      return _mm256_insertf128_pd(_mm256_castpd128_pd256(pair(lane)), pair(lane + 2), 1);
    };
#if ARMCMC_SIMD_LANES == 8
    const auto eight = [four](int lane) noexcept {
      return _mm512_maskz_insertf64x4(0xff, _mm512_castpd256_pd512(four(lane)), four(lane + 4), 1);
    };
    const __m512d even = eight(0), odd = eight(1);
    *low = _mm512_maskz_unpacklo_pd(0xff, even, odd);
    *high = _mm512_maskz_unpackhi_pd(0xff, even, odd);
#else
    const __m256d even = four(0), odd = four(1);
    *low = _mm256_unpacklo_pd(even, odd);
    *high = _mm256_unpackhi_pd(even, odd);
#endif
#else
    *low = Gather(table, index);
    *high = Gather(table + 1, index);
#endif
  }

  /// column[i][lane] = table[4 row[lane] + i]: rows of four are loaded whole.
  static void GatherRows(const double* table, const std::int64_t* row, V* column) noexcept {
#if defined(__AVX512F__) && ARMCMC_SIMD_LANES == 8
    const auto load = [table, row](int lane) noexcept { return _mm256_loadu_pd(table + 4 * row[lane]); };
    const auto two = [load](int lane) noexcept {  // lane, lane + 2
      return _mm512_maskz_insertf64x4(0xff, _mm512_castpd256_pd512(load(lane)), load(lane + 2), 1);
    };
    const __m512d a = two(0), b = two(1), c = two(4), d = two(5);
    const __m512d low0 = _mm512_maskz_unpacklo_pd(0xff, a, b), low1 = _mm512_maskz_unpacklo_pd(0xff, c, d);
    const __m512d high0 = _mm512_maskz_unpackhi_pd(0xff, a, b), high1 = _mm512_maskz_unpackhi_pd(0xff, c, d);
    column[0] = _mm512_maskz_shuffle_f64x2(0xff, low0, low1, 0x88);
    column[1] = _mm512_maskz_shuffle_f64x2(0xff, high0, high1, 0x88);
    column[2] = _mm512_maskz_shuffle_f64x2(0xff, low0, low1, 0xdd);
    column[3] = _mm512_maskz_shuffle_f64x2(0xff, high0, high1, 0xdd);
#elif defined(__AVX2__) && ARMCMC_SIMD_LANES == 4
    const auto load = [table, row](int lane) noexcept { return _mm256_loadu_pd(table + 4 * row[lane]); };
    const __m256d a = load(0), b = load(1), c = load(2), d = load(3);
    const __m256d low0 = _mm256_unpacklo_pd(a, b), low1 = _mm256_unpacklo_pd(c, d);
    const __m256d high0 = _mm256_unpackhi_pd(a, b), high1 = _mm256_unpackhi_pd(c, d);
    column[0] = _mm256_permute2f128_pd(low0, low1, 0x20);
    column[1] = _mm256_permute2f128_pd(high0, high1, 0x20);
    column[2] = _mm256_permute2f128_pd(low0, low1, 0x31);
    column[3] = _mm256_permute2f128_pd(high0, high1, 0x31);
#else
    for (int i = 0; i < 4; ++i) {
      V v{};
      for (int lane = 0; lane < kLanes; ++lane) v[lane] = table[4 * row[lane] + i];
      column[i] = v;
    }
#endif
  }

  /// a b + c, in one rounding where the instruction set has it.
  static V Fma(V a, V b, V c) noexcept {
#if defined(__AVX512F__) && ARMCMC_SIMD_LANES == 8
    return _mm512_fmadd_pd(a, b, c);
#elif defined(__FMA__) && ARMCMC_SIMD_LANES == 4
    return _mm256_fmadd_pd(a, b, c);
#elif defined(ARMCMC_SIMD_NEON)
    return vfmaq_f64(c, a, b);
#else
    return a * b + c;
#endif
  }

  static I Bits(V a) noexcept { return reinterpret_cast<I>(a); }
  static V FromBits(I a) noexcept { return reinterpret_cast<V>(a); }
  static V Select(I mask, V yes, V no) noexcept { return mask ? yes : no; }
  // maskz with a full mask: the plain intrinsics read an uninitialised register in g++ 12's header, which warns.
#if defined(__AVX512F__) && ARMCMC_SIMD_LANES == 8
  static V Max(V a, V b) noexcept { return _mm512_maskz_max_pd(0xff, a, b); }
  static V Min(V a, V b) noexcept { return _mm512_maskz_min_pd(0xff, a, b); }
#elif defined(__AVX2__) && ARMCMC_SIMD_LANES == 4
  static V Max(V a, V b) noexcept { return _mm256_max_pd(a, b); }
  static V Min(V a, V b) noexcept { return _mm256_min_pd(a, b); }
#else
  static V Max(V a, V b) noexcept { return Select(a > b, a, b); }
  static V Min(V a, V b) noexcept { return Select(a < b, a, b); }
#endif
  static V CopySign(V size, V sign) noexcept {
    const I mask = I{} + static_cast<std::int64_t>(0x8000000000000000ULL);
    return FromBits((Bits(size) & ~mask) | (Bits(sign) & mask));
  }
  static V Abs(V a) noexcept { return FromBits(Bits(a) & (I{} + 0x7fffffffffffffffLL)); }

  /// 2^x, relative error below 1 ulp for |x| <= 1000; clamped beyond, and 2^-1000 where x is not a number. Round to
  /// nearest by the magic-number addition, polynomial of degree 11 through the Chebyshev nodes of [-1/2, 1/2] (error
  /// 3e-18), exponent added as an integer.
  static V Exp2(V x) noexcept { return Exp2OfBounded(Min(Max(x, Set(-1000.0)), Set(1000.0))); }
  /// 2^x as doubles have it: 0 and infinity beyond their range, NaN where x is not a number (the hardware's min and max
  /// give their second argument then). Relative error below 3 ulp.
  static V Exp2OrNan(V x) noexcept {
    const V root = Exp2OfBounded(Min(Set(1000.0), Max(Set(-1000.0), x * Set(0.5))));
    return root * root;
  }
  static constexpr double kExp2[] = {4.45581790833606449e-10, 7.07419429728852106e-09, 1.01780570877339407e-07,
                                     1.32154325359123753e-06, 1.52527338415567733e-05, 1.54035304637243530e-04,
                                     1.33335581464064708e-03, 9.61812910758725638e-03, 5.55041086648216248e-02,
                                     2.40226506959101582e-01, 6.93147180559945286e-01, 1.00000000000000000e+00};
  template <int kCount>
  static void Exp2Each(V* x) noexcept {
    for (int i = 0; i < kCount; ++i) x[i] = Exp2(x[i]);
  }
  static V Exp2OfBounded(V x) noexcept {
    const V magic = Set(6755399441055744.0);  // 1.5 * 2^52
    const V shifted = x + magic;
    const V f = x - (shifted - magic);
    V p = Set(kExp2[0]);
    for (std::size_t k = 1; k < sizeof kExp2 / sizeof *kExp2; ++k) p = Fma(p, f, Set(kExp2[k]));
    return FromBits(Bits(p) + (Bits(shifted) << 52));
  }

  /// 2^(exponent log2_x).
  static V Power(V exponent, double log2_x) noexcept { return Exp2(exponent * Set(log2_x)); }

  /// log2 x for normal positive x; absolute error below 1e-15 (1 + |log2 x|). atanh series of the mantissa in
  /// [sqrt(1/2), sqrt(2)).
  static V Log2(V x) noexcept {
    const I offset = I{} + 0x3fe6a09e667f3bcdLL;  // bits of sqrt(1/2)
    const I shifted = Bits(x) - offset;
    const I exponent = shifted >> 52;
    const V m = FromBits(Bits(x) - (exponent << 52));
    // Small integer to double without a conversion instruction: through the magic-number bits.
    const V magic = Set(6755399441055744.0);
    const V e = FromBits(exponent + Bits(magic)) - magic;
    const V s = (m - Set(1.0)) / (m + Set(1.0));
    const V z = s * s;
    V p = Set(1.0 / 21.0);
    p = Fma(p, z, Set(1.0 / 19.0));
    p = Fma(p, z, Set(1.0 / 17.0));
    p = Fma(p, z, Set(1.0 / 15.0));
    p = Fma(p, z, Set(1.0 / 13.0));
    p = Fma(p, z, Set(1.0 / 11.0));
    p = Fma(p, z, Set(1.0 / 9.0));
    p = Fma(p, z, Set(1.0 / 7.0));
    p = Fma(p, z, Set(1.0 / 5.0));
    p = Fma(p, z, Set(1.0 / 3.0));
    p = Fma(p, z, Set(1.0));
    return Fma(s * p, Set(2.8853900817779268147), e);  // 2 / ln 2
  }
};

}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
