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

/// Log-likelihood under another law than the Gaussian, without predictions in memory. Errors of a run first, then what
/// the law makes of them: in one loop a sample would be one chain of operations, too long for a processor to begin the
/// next ones in time.
template <class Forward>
void ScoreLaw(const Forward& forward, const ModeData& data, const ThetaTile& theta, const NoiseModel& noise,
              const double* log_scale, double* out) noexcept {
  constexpr int kGroup = 4;
  const NoiseSettings& s = noise.settings();
  ForLaw<ScoreSimd, kGroup>(s.kind, [&]<class Law>() noexcept {
    for (int v0 = 0; v0 < kVectors; v0 += kGroup) {
      V inverse_scale[static_cast<unsigned>(kGroup)];
      InverseScale<kGroup>(log_scale + v0 * Simd::kLanes, inverse_scale);
      Law law(s, inverse_scale);
      V parameters[static_cast<unsigned>(kGroup)][Forward::kRows];
      for (int g = 0; g < kGroup; ++g)
        for (unsigned i = 0; i < Forward::kRows; ++i)
          parameters[g][i] = forward.Load(theta, i, static_cast<unsigned>((v0 + g) * Simd::kLanes));
      for (int n0 = 0; n0 < data.num_samples; n0 += kRun) {
        const int size = n0 + kRun < data.num_samples ? kRun : data.num_samples - n0;
        V e[static_cast<unsigned>(kRun)][static_cast<unsigned>(kGroup)];
        for (int i = 0; i < size; ++i) {
          const int n = n0 + i;
          const V minus_target = Simd::Set(s.mean - data.target[static_cast<unsigned>(n)]);
          if (forward.Far(n)) {
            for (int g = 0; g < kGroup; ++g) e[i][g] = forward.template AddTo<Simd>(minus_target, parameters[g], n);
          } else {
            for (int g = 0; g < kGroup; ++g)
              e[i][g] = forward.template AddTo<ScoreSimd>(minus_target, parameters[g], n);
          }
        }
        if (data.weighted)
          for (int i = 0; i < size; ++i)
            for (int g = 0; g < kGroup; ++g) e[i][g] = e[i][g] * Simd::Set(data.weight[static_cast<unsigned>(n0 + i)]);
        for (int i = 0; i < size; ++i)
          for (int g = 0; g < kGroup; ++g) law.Add(g, e[i][g]);
        law.EndRun();
      }
      for (int g = 0; g < kGroup; ++g) Simd::Store(out + (v0 + g) * Simd::kLanes, law.Result(g));
    }
    AddConstant<Law>(noise, data.num_samples, log_scale, out);
  });
}

template <class Model>
void ScoreLawPlain(const ModeData& data, const ThetaTile& theta, const NoiseModel& noise, const double* log_scale,
                   double* out) noexcept ARMCMC_NONBLOCKING {
  ScoreLaw(PlainForward<Model>{data}, data, theta, noise, log_scale, out);
}

template <class Model>
void SumSquaresPlain(const ModeData& data, const ThetaTile& theta, double noise_mean,
                     double* out) noexcept ARMCMC_NONBLOCKING {
  SumSquaresOf(PlainForward<Model>{data}, data, theta, noise_mean, out);
}

/// out[lane] = log-likelihood, see Kernels::score.
using ScoreLawFn = void (*)(const ModeData&, const ThetaTile&, const NoiseModel&, const double* log_scale,
                            double*) noexcept ARMCMC_NONBLOCKING;
/// out[lane] = sum_n (weight_n (target_n - mean - F))^2.
using SumSquaresFn = void (*)(const ModeData&, const ThetaTile&, double, double*) noexcept ARMCMC_NONBLOCKING;

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
