// Laws of the measurement noise as sums over the samples; included by kernels.inl, once per instruction set.
//
// Each takes errors of kGroup vectors of candidates, not yet divided by their scales, of which several advance together
// so that the operations of one do not wait for each other, and is notified after every kRun samples. Its result is
// (log-likelihood - samples (constant + Constant() - log scale)) / Slope(). All are even in the error. AddWithScore()
// also gives -(d log p / de) as NoiseModel::SquareWeight has it.

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

constexpr int kRun = 8;

template <int kGroup>
struct LaplaceSum {
  LaplaceSum(const NoiseSettings&, const V* inverse_scale) noexcept { std::copy_n(inverse_scale, kGroup, inverse); }
  static double Slope(const NoiseSettings&) noexcept { return -1.0; }
  static V Constant(const NoiseSettings&) noexcept { return V{}; }
  [[gnu::always_inline]] void Add(const V* e) noexcept {
    for (int g = 0; g < kGroup; ++g) sum[g] = sum[g] + Simd::Abs(e[g]);
  }
  [[gnu::always_inline]] void AddWithScore(const V* e, V* score) noexcept {
    Add(e);
    for (int g = 0; g < kGroup; ++g) {
      const V z = e[g] * inverse[g];
      score[g] = inverse[g] * z / Simd::Max(Simd::Abs(z), Simd::Set(0.5));
    }
  }
  void EndRun() noexcept {}
  [[nodiscard]] V Result(int g) const noexcept { return sum[g] * inverse[g]; }

  V inverse[static_cast<unsigned>(kGroup)];
  V sum[static_cast<unsigned>(kGroup)] = {};
};

template <int kGroup>
struct GaussianSum {
  GaussianSum(const NoiseSettings&, const V* inverse_scale) noexcept { std::copy_n(inverse_scale, kGroup, inverse); }
  static double Slope(const NoiseSettings&) noexcept { return -0.5; }
  static V Constant(const NoiseSettings&) noexcept { return V{}; }
  [[gnu::always_inline]] void Add(const V* e) noexcept {
    for (int g = 0; g < kGroup; ++g) sum[g] = Simd::Fma(e[g], e[g], sum[g]);
  }
  [[gnu::always_inline]] void AddWithScore(const V* e, V* score) noexcept {
    Add(e);
    for (int g = 0; g < kGroup; ++g) score[g] = e[g] * inverse[g] * inverse[g];
  }
  void EndRun() noexcept {}
  [[nodiscard]] V Result(int g) const noexcept { return sum[g] * inverse[g] * inverse[g]; }

  V inverse[static_cast<unsigned>(kGroup)];
  V sum[static_cast<unsigned>(kGroup)] = {};
};

/// Sums of log2 of factors of at least 1: one logarithm for all of them. The product of a run, below 2^1000, is brought
/// back to [1, 2), and its power of two counted.
template <int kGroup>
struct LogProduct {
  LogProduct() noexcept {
    for (V& p : product) p = Simd::Set(1.0);
  }
  void EndRun() noexcept {
    typedef std::uint64_t U __attribute__((vector_size(8 * Simd::kLanes)));  // whose shift every instruction set has
    for (int g = 0; g < kGroup; ++g) {
      const U exponent = (reinterpret_cast<U>(product[g]) >> 52) - 1023;
      powers[g] += reinterpret_cast<Simd::I>(exponent);
      product[g] = Simd::FromBits(Simd::Bits(product[g]) - reinterpret_cast<Simd::I>(exponent << 52));
    }
  }
  [[nodiscard]] V Result(int g) const noexcept {
    const V magic = Simd::Set(6755399441055744.0);  // 1.5 * 2^52: small integers to doubles, through its bits
    return Simd::Log2(product[g]) + (Simd::FromBits(powers[g] + Simd::Bits(magic)) - magic);
  }

  V product[static_cast<unsigned>(kGroup)];
  Simd::I powers[static_cast<unsigned>(kGroup)] = {};
};

/// log2 (1 + e^2 / nu). Factors are kept within what a run of them can hold.
template <int kGroup>
struct StudentSum : LogProduct<kGroup> {
  StudentSum(const NoiseSettings& s, const V* inverse_scale) noexcept : slope(Simd::Set(s.dof + 1.0)) {
    for (int g = 0; g < kGroup; ++g) rate[g] = inverse_scale[g] * inverse_scale[g] * Simd::Set(1.0 / s.dof);
  }
  static double Slope(const NoiseSettings& s) noexcept { return -0.5 * (s.dof + 1.0) * kLn2; }
  static V Constant(const NoiseSettings&) noexcept { return V{}; }
  [[gnu::always_inline]] void Add(const V* e) noexcept {
    V factor[static_cast<unsigned>(kGroup)];
    AddFactor(e, factor);
  }
  [[gnu::always_inline]] void AddWithScore(const V* e, V* score) noexcept {
    V factor[static_cast<unsigned>(kGroup)];
    AddFactor(e, factor);
    for (int g = 0; g < kGroup; ++g) score[g] = e[g] * rate[g] * slope / factor[g];
  }

  V slope;  ///< nu + 1
  V rate[static_cast<unsigned>(kGroup)];

 private:
  /// @param[out] factor  1 + e^2 / (nu s^2)
  [[gnu::always_inline]] void AddFactor(const V* e, V* factor) noexcept {
    for (int g = 0; g < kGroup; ++g) factor[g] = e[g] * e[g];
    for (int g = 0; g < kGroup; ++g) factor[g] = Simd::Fma(factor[g], rate[g], Simd::Set(1.0));
    for (int g = 0; g < kGroup; ++g) factor[g] = Simd::Min(factor[g], Simd::Set(1e30));
    for (int g = 0; g < kGroup; ++g) this->product[g] = this->product[g] * factor[g];
  }
};

/// log2 of p(e) = N(e; c) (w / c) [1 + r exp(-e^2/2 (1 - 1/c^2))], r = (1 - w) c / w, but for what every sample has
/// alike. The bracket lies in [1, 1 + r], r at most 1e10 by the settings, so that a product holds three runs of them.
template <class S, int kGroup>
struct MixtureSum : LogProduct<kGroup> {
  MixtureSum(const NoiseSettings& s, const V* inverse_scale) noexcept
      : log2_ratio(Simd::Log2(Simd::Set((1.0 - s.outlier_weight) * s.outlier_scale / s.outlier_weight))) {
    const double wide = 1.0 / (s.outlier_scale * s.outlier_scale);
    for (int g = 0; g < kGroup; ++g) {
      const V precision = inverse_scale[g] * inverse_scale[g];
      inlier_rate[g] = precision * Simd::Set(-0.5 * kLog2E * (1.0 - wide));
      wide_rate[g] = precision * Simd::Set(-0.5 * kLog2E * wide);
    }
  }
  static double Slope(const NoiseSettings&) noexcept { return kLn2; }
  static V Constant(const NoiseSettings& s) noexcept {
    return Simd::Set(kLn2) * Simd::Log2(Simd::Set(s.outlier_weight / s.outlier_scale));
  }
  [[gnu::always_inline]] void Add(const V* e) noexcept {
    V power[static_cast<unsigned>(kGroup)];
    AddPower(e, power);
  }
  [[gnu::always_inline]] void AddWithScore(const V* e, V* score) noexcept {
    V power[static_cast<unsigned>(kGroup)];
    AddPower(e, power);
    for (int g = 0; g < kGroup; ++g) {
      const V inlier = power[g] / (power[g] + Simd::Set(1.0));
      score[g] = Simd::Set(-2.0 * kLn2) * e[g] * Simd::Fma(inlier_rate[g], inlier, wide_rate[g]);
    }
  }
  void EndRun() noexcept {
    if (++runs % 3 == 0) LogProduct<kGroup>::EndRun();
  }
  [[nodiscard]] V Result(int g) const noexcept {
    return Simd::Fma(wide_rate[g], squares[g], LogProduct<kGroup>::Result(g));
  }

  V log2_ratio;
  V inlier_rate[static_cast<unsigned>(kGroup)], wide_rate[static_cast<unsigned>(kGroup)];
  V squares[static_cast<unsigned>(kGroup)] = {};
  int runs = 0;

 private:
  /// @param[out] power  r exp(-e^2/2 (1 - 1/c^2))
  [[gnu::always_inline]] void AddPower(const V* e, V* power) noexcept {
    for (int g = 0; g < kGroup; ++g) power[g] = e[g] * e[g];
    for (int g = 0; g < kGroup; ++g) squares[g] = squares[g] + power[g];
    for (int g = 0; g < kGroup; ++g) power[g] = Simd::Fma(power[g], inlier_rate[g], log2_ratio);
    for (int g = 0; g < kGroup; ++g) power[g] = Simd::Max(power[g], Simd::Set(-1000.0));
    S::template Exp2Each<kGroup>(power);
    for (int g = 0; g < kGroup; ++g) this->product[g] = Simd::Fma(this->product[g], power[g], this->product[g]);
  }
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

/// exp(-log_scale[lane]) of kGroup vectors.
template <int kGroup>
void InverseScale(const double* log_scale, V* out) noexcept {
  for (int g = 0; g < kGroup; ++g) out[g] = Simd::Exp2(Simd::Load(log_scale + g * Simd::kLanes) * Simd::Set(-kLog2E));
}

/// What a law's result becomes: out = Slope() out + samples (constant + Constant() - log scale).
template <class Law>
void AddConstant(const NoiseModel& noise, int num_samples, const double* log_scale, double* out) noexcept {
  const V slope = Simd::Set(Law::Slope(noise.settings()));
  const V samples = Simd::Set(static_cast<double>(num_samples));
  const V constant = Simd::Set(noise.log_constant()) + Law::Constant(noise.settings());
  for (int v = 0; v < kVectors; ++v) {
    const V per_sample = constant - Simd::Load(log_scale + v * Simd::kLanes);
    Simd::Store(out + v * Simd::kLanes, Simd::Fma(slope, Simd::Load(out + v * Simd::kLanes), samples * per_sample));
  }
}

/// See Kernels::log_likelihood; S has the powers.
template <class S>
void LogLikelihoodBy(const NoiseModel& noise, const ModeData& data, const PredictionTile& tile, const double* log_scale,
                     double* out) noexcept {
  constexpr int kGroup = 4;
  const NoiseSettings& s = noise.settings();
  const V mean = Simd::Set(s.mean);
  ForLaw<S, kGroup>(s.kind, [&]<class Law>() noexcept {
    for (int v0 = 0; v0 < kVectors; v0 += kGroup) {
      V inverse_scale[static_cast<unsigned>(kGroup)];
      InverseScale<kGroup>(log_scale + v0 * Simd::kLanes, inverse_scale);
      Law law(s, inverse_scale);
      for (int n0 = 0; n0 < data.num_samples; n0 += kRun) {
        const int end = n0 + kRun < data.num_samples ? n0 + kRun : data.num_samples;
        for (int n = n0; n < end; ++n) {
          const auto k = static_cast<unsigned>(n);
          const V target = Simd::Set(data.target[k]);
          const V weight = Simd::Set(data.weight[k]);
          V e[static_cast<unsigned>(kGroup)];
          for (int g = 0; g < kGroup; ++g) {
            const V f = Simd::Load(&tile.value[k][static_cast<unsigned>((v0 + g) * Simd::kLanes)]);
            e[g] = (target - f - mean) * weight;
          }
          law.Add(e);
        }
        law.EndRun();
      }
      for (int g = 0; g < kGroup; ++g) Simd::Store(out + (v0 + g) * Simd::kLanes, law.Result(g));
    }
    AddConstant<Law>(noise, data.num_samples, log_scale, out);
  });
}

void LogLikelihood(const NoiseModel& noise, const ModeData& data, const PredictionTile& tile, const double* log_scale,
                   double* out) noexcept ARMCMC_NONBLOCKING {
  LogLikelihoodBy<Simd>(noise, data, tile, log_scale, out);
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
