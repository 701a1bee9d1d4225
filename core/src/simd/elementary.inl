// Elementary functions of many numbers; see armcmc/expression/elementary.hpp.

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

template <class F>
void ForVectors(std::size_t count, const double* a, double* out, F f) noexcept ARMCMC_NONBLOCKING {
  constexpr std::size_t kPair = 2;  // side by side, so that their latencies overlap
  for (std::size_t i = 0; i < count; i += kPair * Simd::kLanes) {
    V x[kPair];
    for (std::size_t v = 0; v < kPair; ++v) x[v] = Simd::Load(a + i + v * Simd::kLanes);
    f(x);
    for (std::size_t v = 0; v < kPair; ++v) Simd::Store(out + i + v * Simd::kLanes, x[v]);
  }
}

template <class F>
void ForEachVector(std::size_t count, const double* a, double* out, F f) noexcept ARMCMC_NONBLOCKING {
  for (std::size_t i = 0; i < count; i += Simd::kLanes) Simd::Store(out + i, f(Simd::Load(a + i)));
}

bool Elementary(expression::Op op, std::size_t count, const double* a, const double* b,
                double* out) noexcept ARMCMC_NONBLOCKING {
  using expression::Op;
  switch (op) {
    case Op::kPower:
      ForVectors(count, a, out, [b](V(&x)[2]) mutable {
        Math::Power(x, b);
        b += 2 * Simd::kLanes;
      });
      return true;
    case Op::kExp: ForVectors(count, a, out, [](V(&x)[2]) { Math::Exp(x); }); return true;
    case Op::kLog: ForVectors(count, a, out, [](V(&x)[2]) { Math::Log(x, kLn2); }); return true;
    case Op::kSin: ForVectors(count, a, out, [](V(&x)[2]) { Math::Sin(x); }); return true;
    case Op::kCos: ForVectors(count, a, out, [](V(&x)[2]) { Math::Cos(x); }); return true;
    case Op::kTan: ForEachVector(count, a, out, [](V x) { return Math::Tan(x); }); return true;
    case Op::kAtan: ForEachVector(count, a, out, [](V x) { return Math::Atan(x); }); return true;
    case Op::kTanh: ForVectors(count, a, out, [](V(&x)[2]) { Math::Tanh(x); }); return true;
    default: return false;
  }
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
