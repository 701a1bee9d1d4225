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

void PredictTape(const ModeData& data, const ThetaTile& theta, PredictionTile* tile) noexcept ARMCMC_NONBLOCKING {
  const Tape& tape = *data.tape;
  TapeRegisters registers;  // NOLINT(cppcoreguidelines-pro-type-member-init): written before read
  StartTape(tape, theta, data.scalars->Row(0), &registers);
  for (std::size_t n = 0; n < static_cast<std::size_t>(data.num_samples); ++n) {
    TapeRunner(&registers, data.scalars->Row(data.sample[n]))
        .Run(tape.code.data() + tape.once, tape.code.data() + tape.size);
    tile->value[n] = registers.value[tape.result[0]];
  }
}

/// out[lane] = sum of the squares of law - target, weighted.
template <bool kWeighted>
void SumTapeSquares(const ModeData& data, const ThetaTile& theta, double* out) noexcept {
  const Tape& tape = *data.error_tape;
  TapeRegisters registers;  // NOLINT(cppcoreguidelines-pro-type-member-init): written before read
  StartTape(tape, theta, data.scalars->Row(0), &registers);
  Simd::V sum[kTapeVectors] = {};
  for (std::size_t n = 0; n < static_cast<std::size_t>(data.num_samples); ++n) {
    TapeRunner(&registers, data.scalars->Row(data.sample[n]))
        .Run(tape.code.data() + tape.once, tape.code.data() + tape.size);
    const double* error = registers.value[tape.result[0]].data();
    for (int v = 0; v < kTapeVectors; ++v) {
      Simd::V e = Simd::Load(error + v * Simd::kLanes);
      if constexpr (kWeighted) e = e * Simd::Set(data.weight[n]);
      sum[v] = Simd::Fma(e, e, sum[v]);
    }
  }
  for (int v = 0; v < kTapeVectors; ++v) Simd::Store(out + v * Simd::kLanes, sum[v]);
}

/// sum[v] += constant + sum of scalars x parameters, for the vectors of a group whose first lane is `lane`.
template <int kGroup>
[[gnu::always_inline]] inline void AddTapeSum(const expression::TapeSum& terms, const double* row,
                                              const ThetaTile& theta, int lane, Simd::V* sum) noexcept {
  const Simd::V constant = terms.constant == expression::TapeSum::kNone ? Simd::V{} : Simd::Set(row[terms.constant]);
  for (int g = 0; g < kGroup; ++g) sum[g] = constant;
  for (std::size_t t = 0; t < terms.count; ++t) {
    const double* parameter = theta.value[terms.parameter[t]].data() + lane;
    const Simd::V scalar = Simd::Set(terms.scalar[t] == expression::TapeSum::kNone ? 1.0 : row[terms.scalar[t]]);
    for (int g = 0; g < kGroup; ++g) sum[g] = Simd::Fma(Simd::Load(parameter + g * Simd::kLanes), scalar, sum[g]);
  }
}

/// The same for a tape with a shape: as many vectors side by side as keep the arithmetic units busy, nothing in memory.
/// Powers carry a relative error of 4e-11, as those of the compiled laws do.
template <bool kWeighted, bool kPower>
void SumShapeSquares(const ModeData& data, const ThetaTile& theta, double* out) noexcept {
  constexpr int kGroup = Simd::kLanes == 8 ? 4 : 2;
  constexpr double kReach = 960.0;  // |exponent log2 x| that needs no clamp
  const Tape& tape = *data.error_tape;
  for (int lane = 0; lane < kTileLanes; lane += kGroup * Simd::kLanes) {
    Simd::V sum[kGroup] = {};
    for (std::size_t n = 0; n < static_cast<std::size_t>(data.num_samples); ++n) {
      const double* row = data.scalars->Row(data.sample[n]);
      Simd::V e[kGroup];
      AddTapeSum<kGroup>(tape.rest, row, theta, lane, e);
      if constexpr (kPower) {
        Simd::V factor[kGroup];
        AddTapeSum<kGroup>(tape.factor, row, theta, lane, factor);
        const double* exponent = theta.value[tape.exponent].data() + lane;
        const double log2 = row[tape.log2];
        if (std::fabs(log2) * tape.largest_exponent <= kReach) {
          for (int g = 0; g < kGroup; ++g)
            e[g] = Simd::Fma(ScoreSimd::Power(Simd::Load(exponent + g * Simd::kLanes), log2), factor[g], e[g]);
        } else {
          for (int g = 0; g < kGroup; ++g)
            e[g] =
                Simd::Fma(Simd::Exp2OrNan(Simd::Load(exponent + g * Simd::kLanes) * Simd::Set(log2)), factor[g], e[g]);
        }
      }
      for (int g = 0; g < kGroup; ++g) {
        if constexpr (kWeighted) e[g] = e[g] * Simd::Set(data.weight[n]);
        sum[g] = Simd::Fma(e[g], e[g], sum[g]);
      }
    }
    for (int g = 0; g < kGroup; ++g) Simd::Store(out + lane + g * Simd::kLanes, sum[g]);
  }
}

template <bool kWeighted>
void SumSquaresOfTape(const ModeData& data, const ThetaTile& theta, double* out) noexcept {
  switch (data.error_tape->shape) {
    case expression::TapeShape::kLinear: SumShapeSquares<kWeighted, false>(data, theta, out); break;
    case expression::TapeShape::kPower: SumShapeSquares<kWeighted, true>(data, theta, out); break;
    case expression::TapeShape::kGeneral: SumTapeSquares<kWeighted>(data, theta, out); break;
  }
}

void SumSquaresTape(const ModeData& data, const ThetaTile& theta, double, double* out) noexcept ARMCMC_NONBLOCKING {
  if (data.weighted) {
    SumSquaresOfTape<true>(data, theta, out);
  } else {
    SumSquaresOfTape<false>(data, theta, out);
  }
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
