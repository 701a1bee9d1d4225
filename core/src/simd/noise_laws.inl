// Laws of the measurement noise as sums over the samples; included by kernels.inl, once per instruction set.
//
// Each takes standardised errors of kGroup vectors of candidates, of which several advance together so that the
// operations of one do not wait for each other, and is told after every kRun samples. Its result is
// (log-likelihood - samples (constant - log scale)) / slope. All are even in the error.

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

constexpr int kRun = 8;

template <int kGroup>
struct LaplaceSum {
  explicit LaplaceSum(const NoiseSettings&) noexcept {}
  static double Slope(const NoiseSettings&) noexcept { return -1.0; }
  [[gnu::always_inline]] void Add(int g, V e) noexcept { sum[g] = sum[g] + Simd::Abs(e); }
  void EndRun() noexcept {}
  [[nodiscard]] V Result(int g) const noexcept { return sum[g]; }

  V sum[static_cast<unsigned>(kGroup)] = {};
};

template <int kGroup>
struct GaussianSum {
  explicit GaussianSum(const NoiseSettings&) noexcept {}
  static double Slope(const NoiseSettings&) noexcept { return -0.5; }
  [[gnu::always_inline]] void Add(int g, V e) noexcept { sum[g] = Simd::Fma(e, e, sum[g]); }
  void EndRun() noexcept {}
  [[nodiscard]] V Result(int g) const noexcept { return sum[g]; }

  V sum[static_cast<unsigned>(kGroup)] = {};
};

/// log2 (1 + e^2 / nu): one logarithm for the product of a run, whose factors are kept within what eight of them can
/// hold.
template <int kGroup>
struct StudentSum {
  explicit StudentSum(const NoiseSettings& s) noexcept : inverse_dof(Simd::Set(1.0 / s.dof)) {
    for (V& p : product) p = Simd::Set(1.0);
  }
  static double Slope(const NoiseSettings& s) noexcept { return -0.5 * (s.dof + 1.0) * kLn2; }
  [[gnu::always_inline]] void Add(int g, V e) noexcept {
    const V factor = Simd::Fma(e * inverse_dof, e, Simd::Set(1.0));
    product[g] = product[g] * Simd::Min(factor, Simd::Set(1e30));
  }
  void EndRun() noexcept {
    for (int g = 0; g < kGroup; ++g) {
      sum[g] = sum[g] + Simd::Log2(product[g]);
      product[g] = Simd::Set(1.0);
    }
  }
  [[nodiscard]] V Result(int g) const noexcept { return sum[g]; }

  V inverse_dof;
  V product[static_cast<unsigned>(kGroup)];
  V sum[static_cast<unsigned>(kGroup)] = {};
};

/// log2 of p(e) = N(e; c) [(1 - w) exp(-e^2/2 (1 - 1/c^2)) + w / c], but for what every sample has alike. The bracket
/// lies in [w / c, 1 + w / c], which settings keep far from 0.
template <class S, int kGroup>
struct MixtureSum {
  explicit MixtureSum(const NoiseSettings& s) noexcept
      : inlier_rate(Simd::Set(-0.5 * kLog2E * (1.0 - 1.0 / (s.outlier_scale * s.outlier_scale)))),
        wide_rate(Simd::Set(-0.5 * kLog2E / (s.outlier_scale * s.outlier_scale))),
        inlier(Simd::Set(1.0 - s.outlier_weight)),
        outlier(Simd::Set(s.outlier_weight / s.outlier_scale)) {
    for (V& p : product) p = Simd::Set(1.0);
  }
  static double Slope(const NoiseSettings&) noexcept { return kLn2; }
  [[gnu::always_inline]] void Add(int g, V e) noexcept {
    const V square = e * e;
    squares[g] = squares[g] + square;
    const V power = S::Exp2(Simd::Max(inlier_rate * square, Simd::Set(-1000.0)));
    product[g] = product[g] * Simd::Fma(inlier, power, outlier);
  }
  void EndRun() noexcept {
    for (int g = 0; g < kGroup; ++g) {
      sum[g] = sum[g] + Simd::Log2(product[g]);
      product[g] = Simd::Set(1.0);
    }
  }
  [[nodiscard]] V Result(int g) const noexcept { return Simd::Fma(wide_rate, squares[g], sum[g]); }

  V inlier_rate, wide_rate, inlier, outlier;
  V product[static_cast<unsigned>(kGroup)];
  V squares[static_cast<unsigned>(kGroup)] = {};
  V sum[static_cast<unsigned>(kGroup)] = {};
};

/// fn.template operator()<Law>(), Law the class template instance of the kind for kGroup vectors.
template <class S, int kGroup, class Fn>
void ForLaw(NoiseKind kind, const Fn& fn) noexcept {
  switch (kind) {
    case NoiseKind::kGaussian: fn.template operator()<GaussianSum<kGroup>>(); break;
    case NoiseKind::kLaplace: fn.template operator()<LaplaceSum<kGroup>>(); break;
    case NoiseKind::kStudentT: fn.template operator()<StudentSum<kGroup>>(); break;
    case NoiseKind::kMixture: fn.template operator()<MixtureSum<S, kGroup>>(); break;
  }
}

/// out[lane] = exp(-log_scale[lane]) of a tile.
void InverseScale(const double* log_scale, double* out) noexcept {
  for (int v = 0; v < kVectors; ++v)
    Simd::Store(out + v * Simd::kLanes, Simd::Exp2(Simd::Load(log_scale + v * Simd::kLanes) * Simd::Set(-kLog2E)));
}

/// What a law's result becomes: out = slope out + samples (constant - log scale).
void AddConstant(const NoiseModel& noise, double slope, int num_samples, const double* log_scale,
                 double* out) noexcept {
  const V samples = Simd::Set(static_cast<double>(num_samples));
  const V constant = Simd::Set(noise.log_constant());
  for (int v = 0; v < kVectors; ++v) {
    const V per_sample = constant - Simd::Load(log_scale + v * Simd::kLanes);
    Simd::Store(out + v * Simd::kLanes,
                Simd::Fma(Simd::Set(slope), Simd::Load(out + v * Simd::kLanes), samples * per_sample));
  }
}

/// See Kernels::log_likelihood; S has the powers.
template <class S>
void LogLikelihoodBy(const NoiseModel& noise, const ModeData& data, const PredictionTile& tile, const double* log_scale,
                     double* out) noexcept {
  constexpr int kGroup = 4;
  alignas(64) double inverse_scale[kTileLanes];
  InverseScale(log_scale, inverse_scale);
  const NoiseSettings& s = noise.settings();
  const V mean = Simd::Set(s.mean);
  ForLaw<S, kGroup>(s.kind, [&]<class Law>() noexcept {
    for (int v0 = 0; v0 < kVectors; v0 += kGroup) {
      Law law(s);
      V inv[static_cast<unsigned>(kGroup)];
      for (int g = 0; g < kGroup; ++g) inv[g] = Simd::Load(inverse_scale + (v0 + g) * Simd::kLanes);
      for (int n0 = 0; n0 < data.num_samples; n0 += kRun) {
        const int end = n0 + kRun < data.num_samples ? n0 + kRun : data.num_samples;
        for (int n = n0; n < end; ++n) {
          const auto k = static_cast<unsigned>(n);
          const V target = Simd::Set(data.target[k]);
          const V weight = Simd::Set(data.weight[k]);
          for (int g = 0; g < kGroup; ++g) {
            const V f = Simd::Load(&tile.value[k][static_cast<unsigned>((v0 + g) * Simd::kLanes)]);
            law.Add(g, (target - f - mean) * (weight * inv[g]));
          }
        }
        law.EndRun();
      }
      for (int g = 0; g < kGroup; ++g) Simd::Store(out + (v0 + g) * Simd::kLanes, law.Result(g));
    }
    AddConstant(noise, Law::Slope(s), data.num_samples, log_scale, out);
  });
}

void LogLikelihood(const NoiseModel& noise, const ModeData& data, const PredictionTile& tile, const double* log_scale,
                   double* out) noexcept ARMCMC_NONBLOCKING {
  LogLikelihoodBy<Simd>(noise, data, tile, log_scale, out);
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
