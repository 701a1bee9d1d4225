// Functions of expressions, for vectors of candidates; included once per instruction set. Accurate to some 1e-15 of the
// larger of result and 1; whatever is not a number, or has no result, gives NaN.

#include <iterator>

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

struct Math {
  using V = Simd::V;
  using I = Simd::I;

  static V Nan() noexcept { return Simd::Set(__builtin_nan("")); }
  /// 1 where the mask is set, else 0.
  static V Condition(I mask) noexcept { return Simd::FromBits(mask & Simd::Bits(Simd::Set(1.0))); }
  static I IsNan(V a) noexcept { return a != a; }

  // The hardware's keep the second argument where one is not a number: so the first has to be looked at.
  static V Min(V a, V b) noexcept { return Simd::Select(IsNan(a), a, Simd::Min(a, b)); }
  static V Max(V a, V b) noexcept { return Simd::Select(IsNan(a), a, Simd::Max(a, b)); }

  static V Sign(V a) noexcept {
    return Simd::Select(a == V{}, V{}, Simd::Select(IsNan(a), a, Simd::CopySign(Simd::Set(1.0), a)));
  }
  static V Step(V a) noexcept { return Simd::Select(IsNan(a), a, Condition(a >= V{})); }

  template <std::size_t kSize>
  static V Polynomial(V x, const double (&highest_first)[kSize]) noexcept {
    V p = Simd::Set(highest_first[0]);
    for (std::size_t i = 1; i < kSize; ++i) p = Simd::Fma(p, x, Simd::Set(highest_first[i]));
    return p;
  }
  /// a - n b, exact where n b is.
  static V Less(V a, V n, double b) noexcept { return Simd::Fma(-n, Simd::Set(b), a); }

  /// e^x, relative error below 4 ulp: the square of the root, so that no factor leaves the range of doubles before the
  /// result does.
  template <std::size_t kCount>
  [[gnu::always_inline]] static void Exp(V (&x)[kCount]) noexcept {
    V shifted[kCount];
    for (V& a : x) a = Simd::Min(Simd::Set(1400.0), Simd::Max(Simd::Set(-1400.0), a)) * Simd::Set(0.5);
    ExpOfRest(x, shifted);
    for (V& a : x) a = a + Simd::Set(1.0);
    for (std::size_t v = 0; v < kCount; ++v) x[v] = Simd::FromBits(Simd::Bits(x[v]) + (Simd::Bits(shifted[v]) << 52));
    for (V& a : x) a = a * a;
  }

  /// log2 x; of 0 a number that is below every other, and finite: 0^p is 0, and 0^0 is 1. Absolute error below
  /// 1e-15 (1 + |log2 x|): atanh series of the mantissa in [sqrt(1/2), sqrt(2)), minimax polynomial.
  template <std::size_t kCount>
  [[gnu::always_inline]] static void Log2(V (&x)[kCount]) noexcept {
    const V one = Simd::Set(1.0);
    V whole[kCount];
    V s[kCount];
    V z[kCount];
    V p[kCount];
    for (std::size_t v = 0; v < kCount; ++v) {
      // Numbers below the smallest normal one are brought up to size.
      const I small = x[v] < Simd::Set(2.2250738585072014e-308);
      const I bits = Simd::Bits(Simd::Select(small, x[v] * Simd::Set(18014398509481984.0), x[v]));
      const I exponent = (bits - (I{} + 0x3fe6a09e667f3bcdLL)) >> 52;  // bits of sqrt(1/2)
      // Small integer to double without a conversion instruction: through the magic-number bits.
      const V n = Simd::FromBits(exponent + Simd::Bits(Simd::Set(kMagic)));
      whole[v] = n - Simd::Select(small, Simd::Set(kMagic + 54.0), Simd::Set(kMagic));
      s[v] = Simd::FromBits(bits - (exponent << 52));
    }
    for (V& a : s) a = (a - one) / (a + one);
    constexpr double kSeries[] = {0.07656264002500184,
                                  0.09091815842791287,
                                  0.11111098528313813,
                                  0.14285714380321302,
                                  0.19999999999651166,
                                  0.33333333333333826,
                                  1.0};
    for (std::size_t v = 0; v < kCount; ++v) z[v] = s[v] * s[v];
    for (V& a : p) a = Simd::Set(0.0740485592996649);
    for (const double coefficient : kSeries)
      for (std::size_t v = 0; v < kCount; ++v) p[v] = Simd::Fma(p[v], z[v], Simd::Set(coefficient));
    for (std::size_t v = 0; v < kCount; ++v)
      whole[v] = Simd::Fma(s[v] * p[v], Simd::Set(2.8853900817779268147), whole[v]);  // 2 / ln 2
    for (std::size_t v = 0; v < kCount; ++v) {
      const I finite = (x[v] >= V{}) & (x[v] <= Simd::Set(1.7976931348623157e308));
      const V other = Simd::Select(x[v] < V{}, Nan(), x[v]);
      x[v] = Simd::Select(x[v] == V{}, Simd::Set(-1e300), Simd::Select(finite, whole[v], other));
    }
  }
  /// factor log2 x, -infinity at 0.
  template <std::size_t kCount>
  [[gnu::always_inline]] static void Log(V (&x)[kCount], double factor) noexcept {
    Log2(x);
    for (V& a : x) a = Simd::Select(a == Simd::Set(-1e300), Simd::Set(-__builtin_inf()), a * Simd::Set(factor));
  }
  /// 2^x of several side by side: Simd::Exp2OrNan().
  template <std::size_t kCount>
  [[gnu::always_inline]] static void Exp2(V (&x)[kCount]) noexcept {
    V shifted[kCount];
    for (V& a : x) a = Simd::Min(Simd::Set(1000.0), Simd::Max(Simd::Set(-1000.0), a * Simd::Set(0.5)));
    for (std::size_t v = 0; v < kCount; ++v) shifted[v] = x[v] + Simd::Set(kMagic);
    for (std::size_t v = 0; v < kCount; ++v) x[v] = x[v] - (shifted[v] - Simd::Set(kMagic));
    V p[kCount];
    for (V& a : p) a = Simd::Set(Simd::kExp2[0]);
    for (std::size_t k = 1; k < std::size(Simd::kExp2); ++k)
      for (std::size_t v = 0; v < kCount; ++v) p[v] = Simd::Fma(p[v], x[v], Simd::Set(Simd::kExp2[k]));
    for (std::size_t v = 0; v < kCount; ++v) p[v] = Simd::FromBits(Simd::Bits(p[v]) + (Simd::Bits(shifted[v]) << 52));
    for (std::size_t v = 0; v < kCount; ++v) x[v] = p[v] * p[v];
  }
  /// base becomes its power. @param exponent  Of the lanes, one after the other.
  template <std::size_t kCount>
  [[gnu::always_inline]] static void Power(V (&base)[kCount], const double* exponent) noexcept {
    Log2(base);
    for (std::size_t v = 0; v < kCount; ++v) base[v] = base[v] * Simd::Load(exponent + v * Simd::kLanes);
    Exp2(base);
  }
  /// Square roots of several vectors side by side, without the hardware's: 1 / sqrt(x) from the exponent, better by a
  /// minimax polynomial (1.1e-8), then one step of Newton's method. Relative error below 2 ulp from 1e-290 on, below
  /// that an absolute one of 1e-140; 0 gives 0.
  template <std::size_t kCount>
  [[gnu::always_inline]] static void Sqrt(V (&x)[kCount]) noexcept {
    constexpr double kHalfInverse[] = {-0.13824470852612578, 0.4623033938455575, -0.8176278781060615,
                                       0.9756629033674393};  // of w in [1.4996, 1.6872]
    constexpr std::int64_t kLargest = 0x7fefffffffffffffLL;
    const auto odd = [](I bits) { return bits | ((I{} + kLargest) - bits); };  // negative: so is x, or not finite
    I any{};
    V half[kCount];  // 1 / (2 sqrt x)
    V root[kCount];
    for (std::size_t v = 0; v < kCount; ++v) any |= odd(Simd::Bits(x[v]));
    for (std::size_t v = 0; v < kCount; ++v)
      half[v] = Simd::FromBits((I{} + 0x5febff50c7b537a9LL) - (Simd::Bits(x[v]) >> 1));
    for (std::size_t v = 0; v < kCount; ++v) root[v] = x[v] * half[v];
    for (std::size_t v = 0; v < kCount; ++v) root[v] = root[v] * half[v];
    V p[kCount];
    for (V& a : p) a = Simd::Set(0.01687317635856974);
    for (const double coefficient : kHalfInverse)
      for (std::size_t v = 0; v < kCount; ++v) p[v] = Simd::Fma(p[v], root[v], Simd::Set(coefficient));
    for (std::size_t v = 0; v < kCount; ++v) half[v] = half[v] * p[v];
    for (std::size_t v = 0; v < kCount; ++v) root[v] = x[v] * half[v];
    for (V& a : root) a = a + a;
    for (std::size_t v = 0; v < kCount; ++v) p[v] = Simd::Fma(-root[v], root[v], x[v]);
    for (std::size_t v = 0; v < kCount; ++v) root[v] = Simd::Fma(p[v], half[v], root[v]);
    if (Simd::Any(any < I{}))
      for (std::size_t v = 0; v < kCount; ++v)
        root[v] = Simd::Select(odd(Simd::Bits(x[v])) < I{}, Simd::Sqrt(x[v]), root[v]);
    for (std::size_t v = 0; v < kCount; ++v) x[v] = root[v];
  }

  /// sin and cos of x, |x| up to 1e7: the quarter turn, then polynomials on [-pi/4, pi/4].
  static void SinCos(V x, V* sine, V* cosine) noexcept {
    const V shifted = x * Simd::Set(0.63661977236758134308) + Simd::Set(kMagic);
    const V n = shifted - Simd::Set(kMagic);
    const V r = Less(Less(Less(x, n, 1.57079625129699707031e+00), n, 7.54978941586159635336e-08), n,
                     5.39030285815811905290e-15);
    const V z = r * r;
    constexpr double kSine[] = {1.58962301576546568060e-10, -2.50507477628578072866e-8, 2.75573136213857245213e-6,
                                -1.98412698295895385996e-4, 8.33333333332211858878e-3,  -1.66666666666666307295e-1};
    constexpr double kCosine[] = {-1.13585365213876817300e-11, 2.08757008419747316778e-9,  -2.75573141792967388112e-7,
                                  2.48015872888517179954e-5,   -1.38888888888730564116e-3, 4.16666666666665929218e-2};
    const V s = Simd::Fma(r * z, Polynomial(z, kSine), r);
    const V c = Simd::Fma(z * z, Polynomial(z, kCosine), Simd::Fma(z, Simd::Set(-0.5), Simd::Set(1.0)));
    const I quarter = Simd::Bits(shifted);
    const I swap = (quarter & 1) == (I{} + 1);
    const V sine_sign = Simd::FromBits((quarter & 2) << 62);
    const V cosine_sign = Simd::FromBits(((quarter + 1) & 2) << 62);
    *sine = Flip(Simd::Select(swap, c, s), sine_sign);
    *cosine = Flip(Simd::Select(swap, s, c), cosine_sign);
  }
  /// To the nearest multiple of pi, then one polynomial on [-pi/2, pi/2]; |x| up to 1e7. Of several vectors side by
  /// side: what one has to wait for is the time of the others.
  template <std::size_t kCount>
  static void Sin(V (&x)[kCount]) noexcept {
    V sign[kCount];
    V n[kCount];
    for (std::size_t v = 0; v < kCount; ++v) {
      const V shifted = Simd::Fma(x[v], Simd::Set(0.31830988618379067154), Simd::Set(kMagic));
      n[v] = shifted - Simd::Set(kMagic);
      sign[v] = Simd::FromBits(Simd::Bits(shifted) << 63);
    }
    SineFrom(n, 2.0, x);
    for (std::size_t v = 0; v < kCount; ++v) x[v] = Flip(x[v], sign[v]);
  }
  /// sin(x + pi/2): to the nearest odd multiple of pi/2.
  template <std::size_t kCount>
  static void Cos(V (&x)[kCount]) noexcept {
    V sign[kCount];
    V odd[kCount];
    for (std::size_t v = 0; v < kCount; ++v) {
      const V shifted = Simd::Fma(x[v], Simd::Set(0.31830988618379067154), Simd::Set(-0.5)) + Simd::Set(kMagic);
      odd[v] = Simd::Fma(shifted - Simd::Set(kMagic), Simd::Set(2.0), Simd::Set(1.0));
      sign[v] = Simd::FromBits(~Simd::Bits(shifted) << 63);
    }
    SineFrom(odd, 1.0, x);
    for (std::size_t v = 0; v < kCount; ++v) x[v] = Flip(x[v], sign[v]);
  }
  static V Tan(V x) noexcept {
    V s;
    V c;
    SinCos(x, &s, &c);
    return s / c;
  }

  /// Of |x| in three ranges around 0, 1 and infinity.
  static V Atan(V x) noexcept {
    const V one = Simd::Set(1.0);
    const V size = Simd::Abs(x);
    const I large = size > Simd::Set(2.41421356237309504880);
    const I middle = (size > Simd::Set(0.66)) & ~large;
    const V reduced =
        Simd::Select(large, Simd::Set(-1.0) / size, Simd::Select(middle, (size - one) / (size + one), size));
    const V base = Simd::Select(large, Simd::Set(1.57079632679489661923),
                                Simd::Select(middle, Simd::Set(0.78539816339744830962), V{}));
    const V z = reduced * reduced;
    constexpr double kAbove[] = {-8.750608600031904122785e-1, -1.615753718733365076637e1, -7.500855792314704667340e1,
                                 -1.228866684490136173410e2, -6.485021904942025371773e1};
    constexpr double kBelow[] = {1.0,
                                 2.485846490142306297962e1,
                                 1.650270098316988542046e2,
                                 4.328810604912902668951e2,
                                 4.853903996359136964868e2,
                                 1.945506571482613964425e2};
    const V angle = base + Simd::Fma(reduced * z, Polynomial(z, kAbove) / Polynomial(z, kBelow), reduced);
    return Simd::Select(IsNan(x), x, Simd::CopySign(angle, x));
  }
  static V Asin(V x) noexcept {
    const V one = Simd::Set(1.0);
    return Atan(x / Simd::Sqrt((one - x) * (one + x)));
  }
  static V Acos(V x) noexcept {
    const V one = Simd::Set(1.0);
    return Simd::Set(2.0) * Atan(Simd::Sqrt((one - x) / (one + x)));
  }

  /// E / (E + 2), E = e^(2 |x|) - 1 = 2^n (e^r - 1) + 2^n - 1: nothing cancels, near 0 either.
  template <std::size_t kCount>
  [[gnu::always_inline]] static void Tanh(V (&x)[kCount]) noexcept {
    const V one = Simd::Set(1.0);
    V e[kCount];
    V shifted[kCount];
    for (std::size_t v = 0; v < kCount; ++v) e[v] = Simd::Abs(x[v]);
    for (V& a : e) a = Simd::Min(Simd::Set(40.0), a + a);
    ExpOfRest(e, shifted);
    for (V& a : shifted) a = Simd::FromBits(Simd::Bits(one) + (Simd::Bits(a) << 52));
    for (std::size_t v = 0; v < kCount; ++v) e[v] = Simd::Fma(shifted[v], e[v], shifted[v] - one);
    for (V& a : e) a = a / (a + Simd::Set(2.0));
    for (std::size_t v = 0; v < kCount; ++v) x[v] = Simd::CopySign(e[v], x[v]);
  }

 private:
  static constexpr double kMagic = 6755399441055744.0;  // 1.5 * 2^52: rounds to an integer, left in the lowest bits

  /// x becomes e^r - 1, r = x - n ln 2 in [-ln 2 / 2, ln 2 / 2], relative error 4e-17 before rounding; n stands in the
  /// lowest bits of `shifted`. |x| below 2^20.
  template <std::size_t kCount>
  [[gnu::always_inline]] static void ExpOfRest(V (&x)[kCount], V (&shifted)[kCount]) noexcept {
    for (std::size_t v = 0; v < kCount; ++v)
      shifted[v] = Simd::Fma(x[v], Simd::Set(1.44269504088896340736), Simd::Set(kMagic));
    // ln 2 in two parts; n times the first is exact.
    for (const double part : {6.93147180369123816490e-01, 1.90821492927058770002e-10})
      for (std::size_t v = 0; v < kCount; ++v) x[v] = Less(x[v], shifted[v] - Simd::Set(kMagic), part);
    constexpr double kRest[] = {2.7620075880100385e-07, 2.7557268480309837e-06, 2.4801521322368448e-05,
                                1.9841269863040545e-04, 1.3888888917196719e-03, 8.3333333333300650e-03,
                                4.1666666666624164e-02, 1.6666666666666669e-01, 5.0000000000000010e-01};
    V square[kCount];
    V p[kCount];
    for (std::size_t v = 0; v < kCount; ++v) square[v] = x[v] * x[v];
    for (V& a : p) a = Simd::Set(2.5100375832651220e-08);
    for (const double coefficient : kRest)
      for (std::size_t v = 0; v < kCount; ++v) p[v] = Simd::Fma(p[v], x[v], Simd::Set(coefficient));
    for (std::size_t v = 0; v < kCount; ++v) x[v] = Simd::Fma(square[v], p[v], x[v]);
  }

  /// x becomes sin(x - n times pi/2 * size): minimax polynomial, relative error 4e-17 before rounding.
  template <std::size_t kCount>
  static void SineFrom(const V (&n)[kCount], double size, V (&x)[kCount]) noexcept {
    const auto less = [&](auto... parts) {
      for (const double part : {parts...})
        for (std::size_t v = 0; v < kCount; ++v) x[v] = Less(x[v], n[v], size * part);
    };
    if constexpr (Simd::kFused) {  // no product is rounded
      less(1.57079632679489661923e+00, 6.12323399573676603587e-17);
    } else {
      less(1.57079625129699707031e+00, 7.54978941586159635336e-08, 5.39030285815811905290e-15);
    }
    constexpr double kSine[] = {-7.64397029616579265158e-13, 1.60589773124442682639e-10,  -2.50521076169958777022e-08,
                                2.75573192191632299576e-06,  -1.98412698412549741303e-04, 8.33333333333331587045e-03,
                                -1.66666666666666657415e-01};
    V z[kCount];
    V p[kCount];
    for (std::size_t v = 0; v < kCount; ++v) z[v] = x[v] * x[v];
    for (std::size_t v = 0; v < kCount; ++v) p[v] = Simd::Set(2.73144475909634010934e-15);
    for (const double coefficient : kSine)
      for (std::size_t v = 0; v < kCount; ++v) p[v] = Simd::Fma(p[v], z[v], Simd::Set(coefficient));
    for (std::size_t v = 0; v < kCount; ++v) x[v] = Simd::Fma(x[v] * z[v], p[v], x[v]);
  }
  static V Flip(V a, V sign) noexcept { return Simd::FromBits(Simd::Bits(a) ^ Simd::Bits(sign)); }
};

/// The vector arithmetic with a power for scoring: relative error below 4.1e-11, which moves the log-likelihood of a
/// hundred samples by less than 1e-6 where the signal is a hundred times the noise.
struct ScoreSimd : Simd {
  static constexpr double kReach = 60.0;  ///< Largest |log2_x|, for exponents within 16.
  /// Coefficients of 2^x behind the highest, of PowerEach() and Exp2Each(). Not in there: a static local may block.
  static constexpr double kPowerSeries[] = {1.54692911308010610e-04, 1.33339225590775254e-03, 9.61802725371136910e-03,
                                            5.55041035345320843e-02, 2.40226511981572077e-01, 6.93147180728445611e-01,
                                            9.99999999961681985e-01};
  static constexpr double kExp2Series[] = {0.0013399930860573837, 0.0096184890475631574, 0.055503287783850101,
                                           0.24022646889789742,   0.69314720573620581,   1.000000000554256};

  /// The same numbers, of which the compiler knows nothing where registers are too few to keep them all: it would make
  /// each an operand in memory of every operation, and loads would be what costs.
  static const double* Unknown(const double* numbers) noexcept {
    if constexpr (Simd::kLanes == 4) asm("" : "+r"(numbers));
    return numbers;
  }

  /// 2^(exponent log2_x), without clamps. Minimax polynomial of degree 7.
  static V Power(V exponent, double log2_x) noexcept {
    const V magic = Set(6755399441055744.0);  // 1.5 * 2^52: rounds to an integer, which it leaves in the lowest bits
    const V x = Set(log2_x);
    const V shifted = Fma(exponent, x, magic);
    return OfParts(Fma(exponent, x, magic - shifted), shifted);
  }
  /// Power() of several exponents, which become the powers, step by step as in Exp2Each().
  template <int kCount>
  [[gnu::always_inline]] static void PowerEach(V* exponent, double log2_x) noexcept {
    const V magic = Set(6755399441055744.0);
    const V x = Set(log2_x);
    V shifted[static_cast<unsigned>(kCount)];
    V p[static_cast<unsigned>(kCount)];
    for (int i = 0; i < kCount; ++i) shifted[i] = Fma(exponent[i], x, magic);
    for (int i = 0; i < kCount; ++i) exponent[i] = Fma(exponent[i], x, magic - shifted[i]);
    for (int i = 0; i < kCount; ++i) p[i] = Set(1.52019226419755621e-05);
    const double* const series = Unknown(kPowerSeries);
    for (std::size_t k = 0; k < std::size(kPowerSeries); ++k) {
      const V c = Set(series[k]);
      for (int i = 0; i < kCount; ++i) p[i] = Fma(p[i], exponent[i], c);
    }
    for (int i = 0; i < kCount; ++i) exponent[i] = FromBits(Bits(p[i]) + (Bits(shifted[i]) << 52));
  }
  /// 2^x for |x| <= 1000.
  static V Exp2(V x) noexcept {
    const V magic = Set(6755399441055744.0);
    const V shifted = x + magic;
    return OfParts(x - (shifted - magic), shifted);
  }
  /// 2^x of several, each |x| <= 1000, step by step: operations that do not wait for each other stand side by side, for
  /// a processor looks ahead only so far. Relative error below 1.9e-9, which is enough for what is added to a density:
  /// a hundred of them move a log-likelihood by less than 2e-7.
  template <int kCount>
  [[gnu::always_inline]] static void Exp2Each(V* x) noexcept {
    const V magic = Set(6755399441055744.0);
    V shifted[static_cast<unsigned>(kCount)];
    V p[static_cast<unsigned>(kCount)];
    for (int i = 0; i < kCount; ++i) shifted[i] = x[i] + magic;
    for (int i = 0; i < kCount; ++i) x[i] = x[i] - (shifted[i] - magic);
    for (int i = 0; i < kCount; ++i) p[i] = Set(0.00015345789023112974);
    const double* const series = Unknown(kExp2Series);
    for (std::size_t k = 0; k < std::size(kExp2Series); ++k) {
      const V c = Set(series[k]);
      for (int i = 0; i < kCount; ++i) p[i] = Fma(p[i], x[i], c);
    }
    for (int i = 0; i < kCount; ++i) x[i] = FromBits(Bits(p[i]) + (Bits(shifted[i]) << 52));
  }
  /// 2^(f + the integer in the lowest bits of `shifted`), |f| <= 1/2.
  static V OfParts(V f, V shifted) noexcept {
    V p = Set(1.52019226419755621e-05);
    p = Fma(p, f, Set(1.54692911308010610e-04));
    p = Fma(p, f, Set(1.33339225590775254e-03));
    p = Fma(p, f, Set(9.61802725371136910e-03));
    p = Fma(p, f, Set(5.55041035345320843e-02));
    p = Fma(p, f, Set(2.40226511981572077e-01));
    p = Fma(p, f, Set(6.93147180728445611e-01));
    p = Fma(p, f, Set(9.99999999961681985e-01));
    return FromBits(Bits(p) + (Bits(shifted) << 52));
  }
};

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
