// Runs tapes; included by kernels.inl, once per instruction set.

#include "armcmc/expression/tape.hpp"
#include "simd/math.inl"

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

using expression::Tape;
using expression::TapeInstruction;
using expression::TapeOp;
using expression::TapeRegisters;

constexpr int kTapeVectors = kTileLanes / Simd::kLanes;

/// One sample of a tape for all candidates of a tile.
class TapeRunner {
 public:
  TapeRunner(TapeRegisters* registers, const double* scalars) noexcept
      : register_(registers->value.data()), scalar_(scalars) {}

  void Run(const TapeInstruction* first, const TapeInstruction* last) noexcept ARMCMC_NONBLOCKING {
    for (const TapeInstruction* i = first; i != last; ++i) i += Execute(*i);
  }

 private:
  using Vec = Simd::V;
  static constexpr int kCount = kTapeVectors;

  [[nodiscard]] double* Register(std::uint8_t r) const noexcept { return register_[r].data(); }
  [[nodiscard]] Vec Scalar(std::uint8_t s) const noexcept { return Simd::Set(scalar_[s]); }

  template <class F>
  void Nullary(const TapeInstruction& i, F f) noexcept {
    double* to = Register(i.to);
    for (int v = 0; v < kCount; ++v) Simd::Store(to + v * Simd::kLanes, f());
  }
  template <class F>
  void Unary(const TapeInstruction& i, F f) noexcept {
    double* to = Register(i.to);
    const double* a = Register(i.a);
    for (int v = 0; v < kCount; ++v) Simd::Store(to + v * Simd::kLanes, f(Simd::Load(a + v * Simd::kLanes)));
  }
  template <class F>
  void Binary(const TapeInstruction& i, F f) noexcept {
    double* to = Register(i.to);
    const double* a = Register(i.a);
    const double* b = Register(i.b);
    for (int v = 0; v < kCount; ++v)
      Simd::Store(to + v * Simd::kLanes, f(Simd::Load(a + v * Simd::kLanes), Simd::Load(b + v * Simd::kLanes)));
  }
  template <class F>
  void Ternary(const TapeInstruction& i, F f) noexcept {
    double* to = Register(i.to);
    const double* a = Register(i.a);
    const double* b = Register(i.b);
    const double* c = Register(i.c);
    for (int v = 0; v < kCount; ++v) {
      const int at = v * Simd::kLanes;
      Simd::Store(to + at, f(Simd::Load(a + at), Simd::Load(b + at), Simd::Load(c + at)));
    }
  }

  /// Two terms at a time, the sum in registers.
  int Linear(const TapeInstruction& i, bool from_register) noexcept {
    Vec sum[kCount];
    for (int v = 0; v < kCount; ++v)
      sum[v] = from_register ? Simd::Load(Register(i.a) + v * Simd::kLanes) : Scalar(i.a);
    const TapeInstruction* terms = &i + 1;
    const int pairs = (i.b + 1) / 2;
    for (int p = 0; p < pairs; ++p) {
      const TapeInstruction& pair = terms[p];
      const double* x = Register(pair.to);
      const Vec s = Scalar(pair.a);
      for (int v = 0; v < kCount; ++v) sum[v] = Simd::Fma(Simd::Load(x + v * Simd::kLanes), s, sum[v]);
      if (2 * p + 1 == i.b) break;
      const double* y = Register(pair.b);
      const Vec t = Scalar(pair.c);
      for (int v = 0; v < kCount; ++v) sum[v] = Simd::Fma(Simd::Load(y + v * Simd::kLanes), t, sum[v]);
    }
    double* to = Register(i.to);
    for (int v = 0; v < kCount; ++v) Simd::Store(to + v * Simd::kLanes, sum[v]);
    return pairs;
  }

  /// @return how many instructions that follow belong to this one.
  int Execute(const TapeInstruction& i) noexcept {
    switch (i.op) {
      case TapeOp::kSplat: Nullary(i, [s = Scalar(i.a)] { return s; }); break;
      case TapeOp::kCopy: Unary(i, [](Vec a) { return a; }); break;
      case TapeOp::kLinear: return Linear(i, false);
      case TapeOp::kAddLinear: return Linear(i, true);
      case TapeOp::kAdd: Binary(i, [](Vec a, Vec b) { return a + b; }); break;
      case TapeOp::kSubtract: Binary(i, [](Vec a, Vec b) { return a - b; }); break;
      case TapeOp::kMultiply: Binary(i, [](Vec a, Vec b) { return a * b; }); break;
      case TapeOp::kMultiplyAdd: Ternary(i, [](Vec a, Vec b, Vec c) { return Simd::Fma(a, b, c); }); break;
      case TapeOp::kMultiplyAddS: Binary(i, [c = Scalar(i.c)](Vec a, Vec b) { return Simd::Fma(a, b, c); }); break;
      case TapeOp::kDivide: Binary(i, [](Vec a, Vec b) { return a / b; }); break;
      case TapeOp::kNegate: Unary(i, [](Vec a) { return -a; }); break;
      case TapeOp::kReciprocal: Unary(i, [](Vec a) { return Simd::Set(1.0) / a; }); break;
      case TapeOp::kAbs: Unary(i, [](Vec a) { return Simd::Abs(a); }); break;
      case TapeOp::kSign: Unary(i, [](Vec a) { return Math::Sign(a); }); break;
      case TapeOp::kSqrt: Unary(i, [](Vec a) { return Simd::Sqrt(a); }); break;
      case TapeOp::kExp: Unary(i, [](Vec a) { return Math::Exp(a); }); break;
      case TapeOp::kExp2S: Unary(i, [s = Scalar(i.b)](Vec a) { return Simd::Exp2OrNan(a * s); }); break;
      case TapeOp::kLog: Unary(i, [](Vec a) { return Math::Log(a, 0.69314718055994530942); }); break;
      case TapeOp::kLog2: Unary(i, [](Vec a) { return Math::Log(a, 1.0); }); break;
      case TapeOp::kLog10: Unary(i, [](Vec a) { return Math::Log(a, 0.30102999566398119521); }); break;
      case TapeOp::kPower: Binary(i, [](Vec a, Vec b) { return Math::Power(a, b); }); break;
      case TapeOp::kPowerInt: Unary(i, [n = static_cast<unsigned>(i.b)](Vec a) { return Math::PowerInt(a, n); }); break;
      case TapeOp::kSin: Unary(i, [](Vec a) { return Math::Sin(a); }); break;
      case TapeOp::kCos: Unary(i, [](Vec a) { return Math::Cos(a); }); break;
      case TapeOp::kTan: Unary(i, [](Vec a) { return Math::Tan(a); }); break;
      case TapeOp::kAsin: Unary(i, [](Vec a) { return Math::Asin(a); }); break;
      case TapeOp::kAcos: Unary(i, [](Vec a) { return Math::Acos(a); }); break;
      case TapeOp::kAtan: Unary(i, [](Vec a) { return Math::Atan(a); }); break;
      case TapeOp::kTanh: Unary(i, [](Vec a) { return Math::Tanh(a); }); break;
      case TapeOp::kMin: Binary(i, [](Vec a, Vec b) { return Math::Min(a, b); }); break;
      case TapeOp::kMax: Binary(i, [](Vec a, Vec b) { return Math::Max(a, b); }); break;
      case TapeOp::kStep: Unary(i, [](Vec a) { return Math::Step(a); }); break;
      case TapeOp::kLess: Binary(i, [](Vec a, Vec b) { return Math::Condition(a < b); }); break;
      case TapeOp::kLessEqual: Binary(i, [](Vec a, Vec b) { return Math::Condition(a <= b); }); break;
      case TapeOp::kEqual: Binary(i, [](Vec a, Vec b) { return Math::Condition(a == b); }); break;
      case TapeOp::kNotEqual: Binary(i, [](Vec a, Vec b) { return Math::Condition(a != b); }); break;
      case TapeOp::kAnd: Binary(i, [](Vec a, Vec b) { return Math::Condition((a != Vec{}) & (b != Vec{})); }); break;
      case TapeOp::kOr: Binary(i, [](Vec a, Vec b) { return Math::Condition((a != Vec{}) | (b != Vec{})); }); break;
      case TapeOp::kNot: Unary(i, [](Vec a) { return Math::Condition(a == Vec{}); }); break;
      case TapeOp::kSelect: Ternary(i, [](Vec a, Vec b, Vec c) { return Simd::Select(a != Vec{}, b, c); }); break;
    }
    return 0;
  }

  std::array<double, kTileLanes>* register_;
  const double* scalar_;
};

/// Parameters into their registers, and what needs no sample.
void StartTape(const Tape& tape, const ThetaTile& theta, const double* scalars,
               TapeRegisters* registers) noexcept ARMCMC_NONBLOCKING {
  for (std::size_t d = 0; d < static_cast<std::size_t>(tape.num_parameters); ++d) registers->value[d] = theta.value[d];
  TapeRunner(registers, scalars).Run(tape.code.data(), tape.code.data() + tape.once);
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
