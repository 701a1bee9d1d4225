// Sums of squared errors without predictions in memory; included by kernels.inl, once per instruction set.

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

/// A model as the scoring loop sees it: which rows of the ThetaTile it reads, and base + F(x_n, theta). Far(n): the
/// power of a base needs the exact Simd, not ScoreSimd.
template <class Model>
struct PlainForward {
  static constexpr unsigned kRows = static_cast<unsigned>(Model::kInfo.num_parameters);
  const ModeData& data;
  static Simd::V Load(const ThetaTile& theta, unsigned i, unsigned lane) noexcept {
    return Simd::Load(&theta.value[i][lane]);
  }
  bool Far(int n) const noexcept { return Model::LargestLog2(data, n) > ScoreSimd::kReach; }
  template <class S>
  Simd::V AddTo(Simd::V base, const Simd::V* theta, int n) const noexcept {
    return Model::template AddTo<S>(base, theta, data, n);
  }
};

/// sum[g] += (weight_n (target_n - mean - F))^2 at sample n.
template <class S, bool kWeighted, int kGroup, class Forward>
void AddSquares(const Forward& forward, const ModeData& data, const V (*parameters)[Forward::kRows], double noise_mean,
                int n, V* sum) noexcept {
  const auto in = static_cast<unsigned>(n);
  const V minus_target = Simd::Set(noise_mean - data.target[in]);
  for (int g = 0; g < kGroup; ++g) {
    V e = forward.template AddTo<S>(minus_target, parameters[g], n);
    if constexpr (kWeighted) e = e * Simd::Set(data.weight[in]);
    sum[g] = Simd::Fma(e, e, sum[g]);
  }
}

/// out[lane] = sum_n (weight_n (target_n - mean - F))^2. Several vectors advance together, so that the chain of
/// operations of one does not keep the arithmetic units waiting.
template <bool kWeighted, class Forward>
void SumSquares(const Forward& forward, const ModeData& data, const ThetaTile& theta, double noise_mean,
                double* out) noexcept {
  // As many as there are registers for: AVX-512 has twice as many of them.
  constexpr int kGroup = Simd::kLanes == 8 && Forward::kRows <= 4 ? 4 : 2;
  for (int v0 = 0; v0 < kVectors; v0 += kGroup) {
    V parameters[static_cast<unsigned>(kGroup)][Forward::kRows];
    V sum[static_cast<unsigned>(kGroup)];
    for (int g = 0; g < kGroup; ++g) {
      const auto lane = static_cast<unsigned>((v0 + g) * Simd::kLanes);
      for (unsigned i = 0; i < Forward::kRows; ++i) parameters[g][i] = forward.Load(theta, i, lane);
      sum[g] = V{};
    }
    for (int n = 0; n < data.num_samples; ++n) {
      if (forward.Far(n)) {
        AddSquares<Simd, kWeighted, kGroup>(forward, data, parameters, noise_mean, n, sum);
      } else {
        AddSquares<ScoreSimd, kWeighted, kGroup>(forward, data, parameters, noise_mean, n, sum);
      }
    }
    for (int g = 0; g < kGroup; ++g) Simd::Store(out + (v0 + g) * Simd::kLanes, sum[g]);
  }
}

template <class Forward>
void SumSquaresOf(const Forward& forward, const ModeData& data, const ThetaTile& theta, double noise_mean,
                  double* out) noexcept {
  if (data.weighted) {
    SumSquares<true>(forward, data, theta, noise_mean, out);
  } else {
    SumSquares<false>(forward, data, theta, noise_mean, out);
  }
}

template <class Model>
void SumSquaresPlain(const ModeData& data, const ThetaTile& theta, double noise_mean,
                     double* out) noexcept ARMCMC_NONBLOCKING {
  SumSquaresOf(PlainForward<Model>{data}, data, theta, noise_mean, out);
}

/// out[lane] = sum_n (weight_n (target_n - mean - F))^2.
using SumSquaresFn = void (*)(const ModeData&, const ThetaTile&, double, double*) noexcept ARMCMC_NONBLOCKING;

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
