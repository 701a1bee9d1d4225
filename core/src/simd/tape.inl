// Runs tapes; included by kernels.inl, once per instruction set.

#include <bit>
#include <cmath>
#include <cstddef>
#include <utility>

#include "armcmc/expression/tape.hpp"
#include "simd/math.inl"

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

using expression::Tape;
using expression::TapeInstruction;
using expression::TapeOp;

constexpr std::size_t kTapeVectors = kTileLanes / Simd::kLanes;  ///< Of a tile.

/// Registers of kSize candidates: half a tile, one, or two.
template <std::size_t kSize>
struct alignas(64) TapeRegisters {
  static constexpr std::size_t kLanes = kSize;
  std::array<std::array<double, kLanes>, expression::kMaxTapeRegisters> value;
};

/// What was kept `back` samples before a place; of a negative `back` what is at the place. Between samples both the
/// line and what is looked up in it are linear.
inline double Past(const double* lines, double place, double back) noexcept {
  constexpr double kLength = expression::PastLines::kLength;
  const double oldest = std::floor(place / kLength) * kLength;
  const auto before = [&](double sample) {
    const double at = back > 0.0 ? std::fmax(sample - back, oldest) : sample;
    const double whole = std::floor(at);
    const double part = at - whole;
    const double* const kept = lines + static_cast<std::ptrdiff_t>(whole);
    return part > 0.0 ? kept[0] + part * (kept[1] - kept[0]) : kept[0];
  };
  if (back != back) return back;
  const double sample = std::floor(place);
  const double part = place - sample;
  const double value = before(sample);
  return part > 0.0 ? value + part * (before(sample + 1.0) - value) : value;
}

/// One sample of a tape for a group of the candidates: as many vectors side by side as leave hardware registers for
/// intermediate results, so that their latencies overlap. The result of one instruction stays
/// there for the next.
template <std::size_t kSize>
class TapeGroup {
 public:
  using Vec = Simd::V;
  static constexpr std::size_t kVectors = kSize < 8 * Simd::kLanes ? kSize / Simd::kLanes : 8;
  static constexpr std::size_t kLanes = kVectors * Simd::kLanes;

  /// Inlined, since a vector that is passed to a function is stored in memory.
  [[gnu::flatten]] static void Run(const TapeInstruction* first, const TapeInstruction* last, double* registers,
                                   const double* scalars, const double* past) noexcept {
    const TapeGroup group(registers, scalars, past);
    Vec x[kVectors] = {};
    for (const TapeInstruction* at = first; at != last; ++at) {
      const TapeInstruction& i = *at;
      if (i.loads) Each([&x, a = group.Register(i.a)](std::size_t v) { x[v] = At(a, v); });
      at += group.Execute(i, x);
      if (i.stores) Each([&x, to = group.Register(i.to)](std::size_t v) { Simd::Store(to + v * Simd::kLanes, x[v]); });
    }
  }

 private:
  /// @param registers  Of the group's first lane.
  TapeGroup(double* registers, const double* scalars, const double* past) noexcept
      : registers_(registers), scalars_(scalars), past_(past) {}

  [[nodiscard]] double* Register(std::uint8_t r) const noexcept {
    return registers_ + r * TapeRegisters<kSize>::kLanes;
  }
  [[nodiscard]] Vec Scalar(std::uint8_t s) const noexcept { return Simd::Set(scalars_[s]); }
  static Vec At(const double* r, std::size_t v) noexcept { return Simd::Load(r + v * Simd::kLanes); }

  /// Loops that must be unrolled: an array of vectors that is indexed by a variable
  /// would live in memory.
  template <class F>
  [[gnu::always_inline]] static void Each(F f) noexcept {
    [f]<std::size_t... v>(std::index_sequence<v...>) { (f(v), ...); }
    (std::make_index_sequence<kVectors>{});
  }
  template <class F>
  [[gnu::always_inline]] static void Unary(Vec* a, F f) noexcept {
    Each([a, f](std::size_t v) { a[v] = f(a[v]); });
  }
  /// For functions that justify a store and a load, and are too long to be inlined for every vector.
  template <class F>
  [[gnu::always_inline]] static void Long(Vec* a, F f) noexcept {
    Vec value[kVectors];
    Each([&value, a](std::size_t v) { value[v] = a[v]; });
#pragma GCC unroll 2
    for (Vec& v : value) v = f(v);  // in order
    Each([&value, a](std::size_t v) { a[v] = value[v]; });
  }
  /// For functions of several vectors side by side.
  template <class F>
  [[gnu::always_inline]] static void InFours(Vec* a, F f) noexcept {
    constexpr std::size_t kFour = kVectors < 4 ? kVectors : 4;
    Vec value[kVectors / kFour][kFour];
    Each([&value, a](std::size_t v) { value[v / kFour][v % kFour] = a[v]; });
    for (auto& four : value) f(four);
    Each([&value, a](std::size_t v) { a[v] = value[v / kFour][v % kFour]; });
  }
  /// The lanes of the first half of a tile by the hardware's instruction, which keeps its unit busy for as long as
  /// sixteen products, and the others by products meanwhile: the same lanes in every instruction set that fuses them.
  [[gnu::always_inline]] static void SquareRoots(Vec* a) noexcept {
    if constexpr (kVectors < kTapeVectors) {
      Unary(a, [](Vec x) { return Simd::Sqrt(x); });
    } else {
      constexpr std::size_t kHalf = kTapeVectors / 2;
      Vec value[kVectors / 2];
      Each([&value, a](std::size_t v) {
        if (v % kTapeVectors < kHalf)
          a[v] = Simd::Sqrt(a[v]);
        else
          value[v / kTapeVectors * kHalf + v % kHalf] = a[v];
      });
      Math::Sqrt(value);
      Each([&value, a](std::size_t v) {
        if (v % kTapeVectors >= kHalf) a[v] = value[v / kTapeVectors * kHalf + v % kHalf];
      });
    }
  }
  /// Whole powers by squaring; exponent in [0, 255].
  [[gnu::always_inline]] static void WholePower(Vec* a, unsigned exponent) noexcept {
    if (exponent == 0) return Unary(a, [](Vec) { return Simd::Set(1.0); });
    Vec base[kVectors];
    Each([&base, a](std::size_t v) { base[v] = a[v]; });
    for (unsigned bit = std::bit_floor(exponent) >> 1; bit != 0; bit >>= 1) {
      Each([a](std::size_t v) { a[v] = a[v] * a[v]; });
      if ((exponent & bit) != 0) Each([&base, a](std::size_t v) { a[v] = a[v] * base[v]; });
    }
  }
  template <class F>
  [[gnu::always_inline]] void Binary(Vec* a, const TapeInstruction& i, F f) const noexcept {
    const double* b = Register(i.b);
    Each([a, b, f](std::size_t v) { a[v] = f(a[v], At(b, v)); });
  }
  template <class F>
  [[gnu::always_inline]] void Ternary(Vec* a, const TapeInstruction& i, F f) const noexcept {
    const double* b = Register(i.b);
    const double* c = Register(i.c);
    Each([a, b, c, f](std::size_t v) { a[v] = f(a[v], At(b, v), At(c, v)); });
  }
  /// a += the terms of the sum `i`, two an instruction. @return how many instructions hold them.
  [[gnu::always_inline]] int AddTerms(Vec* a, const TapeInstruction& i) const noexcept {
    const auto add = [a](const double* x, Vec s) { Each([=](std::size_t v) { a[v] = Simd::Fma(At(x, v), s, a[v]); }); };
    const TapeInstruction* term = &i + 1;
    for (int left = i.b; left > 0; left -= 2, ++term) {
      add(Register(term->to), Scalar(term->a));
      if (left > 1) add(Register(term->b), Scalar(term->c));
    }
    return (i.b + 1) / 2;
  }

  /// @return how many instructions that follow belong to this one.
  [[gnu::always_inline]] int Execute(const TapeInstruction& i, Vec* x) const noexcept {
    switch (i.op) {
      case TapeOp::kSplat: Unary(x, [s = Scalar(i.a)](Vec) { return s; }); break;
      case TapeOp::kCopy: break;
      case TapeOp::kLinear: Unary(x, [s = Scalar(i.a)](Vec) { return s; }); return AddTerms(x, i);
      case TapeOp::kAddLinear: return AddTerms(x, i);
      case TapeOp::kAdd: Binary(x, i, [](Vec a, Vec b) { return a + b; }); break;
      case TapeOp::kSubtract: Binary(x, i, [](Vec a, Vec b) { return a - b; }); break;
      case TapeOp::kMultiply: Binary(x, i, [](Vec a, Vec b) { return a * b; }); break;
      case TapeOp::kMultiplyAdd: Ternary(x, i, [](Vec a, Vec b, Vec c) { return Simd::Fma(a, b, c); }); break;
      case TapeOp::kMultiplyAddS: Binary(x, i, [c = Scalar(i.c)](Vec a, Vec b) { return Simd::Fma(a, b, c); }); break;
      case TapeOp::kAddProduct: Ternary(x, i, [](Vec a, Vec b, Vec c) { return Simd::Fma(b, c, a); }); break;
      case TapeOp::kTakeProduct: Ternary(x, i, [](Vec a, Vec b, Vec c) { return Simd::Fma(-a, b, c); }); break;
      case TapeOp::kLessProduct: Ternary(x, i, [](Vec a, Vec b, Vec c) { return Simd::Fma(-b, c, a); }); break;
      case TapeOp::kScale: Unary(x, [s = Scalar(i.b)](Vec a) { return a * s; }); break;
      case TapeOp::kScaleAdd: Binary(x, i, [s = Scalar(i.c)](Vec a, Vec b) { return Simd::Fma(a, s, b); }); break;
      case TapeOp::kDivide: Binary(x, i, [](Vec a, Vec b) { return a / b; }); break;
      case TapeOp::kNegate: Unary(x, [](Vec a) { return -a; }); break;
      case TapeOp::kReciprocal: Unary(x, [](Vec a) { return Simd::Set(1.0) / a; }); break;
      case TapeOp::kAbs: Unary(x, [](Vec a) { return Simd::Abs(a); }); break;
      case TapeOp::kSign: Unary(x, [](Vec a) { return Math::Sign(a); }); break;
      case TapeOp::kSqrt: SquareRoots(x); break;
      case TapeOp::kExp: InFours(x, [](auto& a) { Math::Exp(a); }); break;
      case TapeOp::kExp2S:
        Unary(x, [s = Scalar(i.b)](Vec a) { return a * s; });
        InFours(x, [](auto& a) { Math::Exp2(a); });
        break;
      case TapeOp::kLog: InFours(x, [](auto& a) { Math::Log(a, 0.69314718055994530942); }); break;
      case TapeOp::kLog2: InFours(x, [](auto& a) { Math::Log(a, 1.0); }); break;
      case TapeOp::kLog10: InFours(x, [](auto& a) { Math::Log(a, 0.30102999566398119521); }); break;
      case TapeOp::kPower:
        InFours(x, [b = Register(i.b)](auto& a) mutable {
          Math::Power(a, b);
          b += std::size(a) * Simd::kLanes;
        });
        break;
      case TapeOp::kPowerInt: WholePower(x, i.b); break;
      case TapeOp::kSin: InFours(x, [](auto& a) { Math::Sin(a); }); break;
      case TapeOp::kCos: InFours(x, [](auto& a) { Math::Cos(a); }); break;
      case TapeOp::kTan: Long(x, [](Vec a) { return Math::Tan(a); }); break;
      case TapeOp::kAsin: Long(x, [](Vec a) { return Math::Asin(a); }); break;
      case TapeOp::kAcos: Long(x, [](Vec a) { return Math::Acos(a); }); break;
      case TapeOp::kAtan: Long(x, [](Vec a) { return Math::Atan(a); }); break;
      case TapeOp::kTanh: InFours(x, [](auto& a) { Math::Tanh(a); }); break;
      case TapeOp::kMin: Binary(x, i, [](Vec a, Vec b) { return Math::Min(a, b); }); break;
      case TapeOp::kMax: Binary(x, i, [](Vec a, Vec b) { return Math::Max(a, b); }); break;
      // No check needed: the hardware's return their second argument if one is NaN.
      case TapeOp::kMinS: Unary(x, [s = Scalar(i.b)](Vec a) { return Simd::Min(s, a); }); break;
      case TapeOp::kMaxS: Unary(x, [s = Scalar(i.b)](Vec a) { return Simd::Max(s, a); }); break;
      case TapeOp::kStep: Unary(x, [](Vec a) { return Math::Step(a); }); break;
      case TapeOp::kLess: Binary(x, i, [](Vec a, Vec b) { return Math::Condition(a < b); }); break;
      case TapeOp::kLessEqual: Binary(x, i, [](Vec a, Vec b) { return Math::Condition(a <= b); }); break;
      case TapeOp::kEqual: Binary(x, i, [](Vec a, Vec b) { return Math::Condition(a == b); }); break;
      case TapeOp::kNotEqual: Binary(x, i, [](Vec a, Vec b) { return Math::Condition(a != b); }); break;
      case TapeOp::kAnd: Binary(x, i, [](Vec a, Vec b) { return Math::Condition((a != Vec{}) & (b != Vec{})); }); break;
      case TapeOp::kOr: Binary(x, i, [](Vec a, Vec b) { return Math::Condition((a != Vec{}) | (b != Vec{})); }); break;
      case TapeOp::kNot: Unary(x, [](Vec a) { return Math::Condition(a == Vec{}); }); break;
      case TapeOp::kSelect: Ternary(x, i, [](Vec a, Vec b, Vec c) { return Simd::Select(a != Vec{}, b, c); }); break;
      case TapeOp::kPast:
        Long(x, [past = past_, place = scalars_[i.b]](Vec a) {
          alignas(64) double lane[Simd::kLanes];
          Simd::Store(lane, a);
          for (double& back : lane) back = Past(past, place, back);
          return Simd::Load(lane);
        });
        break;
    }
    return 0;
  }

  double* registers_;
  const double* scalars_;
  const double* past_;  ///< PastLines::value.
};

template <std::size_t kSize>
void RunCode(const TapeInstruction* first, const TapeInstruction* last, const double* scalars, const double* past,
             TapeRegisters<kSize>* registers) noexcept ARMCMC_NONBLOCKING {
  for (std::size_t lane = 0; lane < TapeRegisters<kSize>::kLanes; lane += TapeGroup<kSize>::kLanes)
    TapeGroup<kSize>::Run(first, last, registers->value[0].data() + lane, scalars, past);
}
/// What needs the sample.
template <std::size_t kSize>
void RunTape(const Tape& tape, const double* scalars, const double* past,
             TapeRegisters<kSize>* registers) noexcept ARMCMC_NONBLOCKING {
  RunCode(tape.code.data() + tape.once, tape.code.data() + tape.code.size(), scalars, past, registers);
}
/// What needs no sample.
template <std::size_t kSize>
void StartTape(const Tape& tape, const double* scalars, TapeRegisters<kSize>* registers) noexcept ARMCMC_NONBLOCKING {
  RunCode(tape.code.data(), tape.code.data() + tape.once, scalars, nullptr, registers);
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
